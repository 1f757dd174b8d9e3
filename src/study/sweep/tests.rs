//! Parts, merges and planted faults.
