//! A process group that ends when this process ends, however that happens.

use etalon_core::error::{Error, Result};
use std::process::Command;

/// A group of processes, all of which are killed when this is dropped, and also when this process ends without dropping it: by
/// a signal, even SIGKILL, or in a crash.
///
/// The group's leader is a shell that waits at a pipe whose other end only this process holds; when that end closes, the shell
/// kills its group. The leader is started before any member and waited for after the group was killed, so that at no moment
/// a member is without it, and the number of the group is not used again meanwhile.
///
/// A process that leaves the group (`setsid`, `setpgid`) is not ended. Where there are no process groups, none is.
#[derive(Debug)]
pub struct Group {
    #[cfg(unix)]
    leader: std::process::Child,
}

#[cfg(unix)]
impl Group {
    /// Starts the leader.
    ///
    /// # Errors
    /// [`Error::Io`] where there is no shell.
    pub fn start() -> Result<Self> {
        use std::os::unix::process::CommandExt;
        use std::process::Stdio;
        const SHELL: &str = "/bin/sh";
        // A member that signals its whole group, or reads from a terminal in the background, must not end or stop the leader.
        const WAIT: &str = "trap '' HUP INT QUIT TERM USR1 USR2 TSTP TTIN TTOU; read -r line; kill -KILL 0";
        let mut shell = Command::new(SHELL);
        shell.args(["-c", WAIT]).stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null()).process_group(0);
        let leader = shell.spawn().map_err(|e| {
            let needed = "it is needed to end other programs with this one";
            Error::io(SHELL.as_ref(), std::io::Error::new(e.kind(), format!("{e}; {needed}")))
        })?;
        Ok(Self { leader })
    }

    /// Makes the process that `command` starts a member.
    pub fn add(&self, command: &mut Command) {
        std::os::unix::process::CommandExt::process_group(command, self.id());
    }

    /// The number of the group, which is that of its leader: process numbers fit.
    fn id(&self) -> i32 {
        self.leader.id() as i32
    }
}

#[cfg(unix)]
impl Drop for Group {
    fn drop(&mut self) {
        use nix::sys::signal::{Signal, killpg};
        // Both fail only if a member has killed the leader, and then there may be nothing left to kill.
        let _ = killpg(nix::unistd::Pid::from_raw(self.id()), Signal::SIGKILL);
        let _ = self.leader.wait();
    }
}

#[cfg(not(unix))]
impl Group {
    /// Does nothing: there are no process groups.
    pub fn start() -> Result<Self> {
        Ok(Self {})
    }

    /// Does nothing.
    pub fn add(&self, _: &mut Command) {}
}

#[cfg(unix)]
#[cfg(test)]
mod tests {

    use super::*;
    use std::os::unix::process::ExitStatusExt;
    use std::process::Child;

    fn member(group: &Group, script: &str) -> Child {
        let mut command = Command::new("sh");
        group.add(command.args(["-c", script]));
        command.spawn().unwrap()
    }

    #[test]
    fn each_group_ends_by_itself() {
        let (one, two) = (Group::start().unwrap(), Group::start().unwrap());
        let [mut first, mut second] = [&one, &two].map(|group| member(group, "sleep 1000; :"));
        drop(one);
        assert_eq!(first.wait().unwrap().signal(), Some(9));
        assert_eq!(second.try_wait().unwrap(), None);
        drop(two);
        assert_eq!(second.wait().unwrap().signal(), Some(9));
    }

    #[test]
    fn a_group_ends_when_the_pipe_closes() {
        let mut group = Group::start().unwrap();
        let mut member = member(&group, "trap '' HUP INT TERM; while :; do sleep 1000; done");
        // What the system does when this process ends.
        drop(group.leader.stdin.take());
        assert_eq!(member.wait().unwrap().signal(), Some(9));
    }
}
