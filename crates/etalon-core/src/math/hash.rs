//! A hash of many words, by which inputs are told from others.

use etalon_random::hash::mix64;

/// A hash of words that goes on from `start`.
///
/// Words go to several hashes in turn, so that one step need not wait for the last; they are then hashed together.
pub fn hash_words(start: u64, words: impl IntoIterator<Item = u32>) -> u64 {
    let mut turns = [start; 8];
    for (i, word) in words.into_iter().enumerate() {
        let hash = &mut turns[i % 8];
        *hash = mix64(*hash ^ u64::from(word)).wrapping_add(1);
    }
    turns.into_iter().fold(start, |sum, hash| mix64(sum ^ hash).wrapping_add(1))
}
