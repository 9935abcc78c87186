//! How much of what takes long is run.

/// `full` under `VIDEG_SOAK=full`, as in the stage `soak`; else `short`.
pub fn extent<T>(short: T, full: T) -> T {
    if std::env::var_os("VIDEG_SOAK").is_some_and(|extent| extent == "full") { full } else { short }
}
