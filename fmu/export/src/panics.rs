//! Panics of a model end here.

use core::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Keeps a panic from unwinding into C.
pub(crate) fn guard<T>(otherwise: T, body: impl FnOnce() -> T) -> T {
    catch_unwind(AssertUnwindSafe(body)).unwrap_or_else(|payload| {
        let _ = panic_message(payload);
        otherwise
    })
}

/// The text of a panic. A payload that is no text is leaked: its destructor might panic in turn.
pub(crate) fn panic_message(payload: Box<dyn Any + Send>) -> String {
    match payload.downcast::<String>() {
        Ok(text) => *text,
        Err(payload) => match payload.downcast::<&'static str>() {
            Ok(text) => (*text).to_owned(),
            Err(payload) => {
                core::mem::forget(payload);
                "no message".to_owned()
            }
        },
    }
}

#[cfg(test)]
mod tests {
    use super::panic_message;

    #[test]
    fn a_panic_has_its_text_whatever_its_payload() {
        assert_eq!(panic_message(Box::new("text")), "text");
        assert_eq!(panic_message(Box::new("owned".to_owned())), "owned");
        // Never dropped: of a size of 0, so that Miri sees no leak.
        assert_eq!(panic_message(Box::new(())), "no message");
    }
}
