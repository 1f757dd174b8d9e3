//! The study finds what is planted, and keeps what it promises.

use super::error::{Exact, Off};
use super::*;

fn quick(names: &[&str]) -> Stability {
    run(names, &Effort::QUICK, 1, &mut |_| {}).unwrap()
}

#[test]
fn probe() {
    let effort = if std::env::var("FULL").is_ok() { Effort::FULL } else { Effort::QUICK };
    let mut last: Option<(&'static str, std::time::Instant)> = None;
    let s = run::<&str>(&[], &effort, 1, &mut |name| {
        if let Some((n, t)) = last.replace((name, std::time::Instant::now())) {
            println!("{n} {:.2}", t.elapsed().as_secs_f64());
        }
    })
    .unwrap();
    for r in s.rows {
        println!(
            "{:16} {:14} {} {:9} rel {:8.2e} ulp {:9.3e} cond {:8.2e} u/c {:9.3e} | {} {} {} | {}",
            r.family,
            r.form,
            r.precision.name(),
            r.cases,
            r.max_relative,
            r.max_ulp,
            r.condition_at_worst,
            r.max_ulp_per_condition,
            r.non_finite,
            r.negative,
            r.out_of_range,
            r.worst
        );
    }
    for p in s.promises {
        println!("{p:?}");
    }
}
