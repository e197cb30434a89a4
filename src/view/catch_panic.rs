//! Panics of work that a thread does for the window: they are said, and the thread goes on with its next
//! request.

use anyhow::{Result, anyhow};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What comes of work; of a panic, an error that says what was being done. What the work was changing must
/// not be used afterwards.
pub fn catch_panic<T>(doing: &str, work: impl FnOnce() -> Result<T>) -> Result<T> {
    catch_unwind(AssertUnwindSafe(work))
        .unwrap_or_else(|panic| Err(anyhow!("{doing}: this is a bug: {}", said(&*panic))))
}

/// What a panic says.
fn said(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("it stopped without a word")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_said_with_what_was_being_done() {
        let numbers = Vec::<u32>::new();
        let error = catch_panic("ao of room:7", || Ok(numbers[3])).expect_err("there is no such number");
        let text = error.to_string();
        assert!(text.starts_with("ao of room:7: ") && text.contains("out of bounds"), "{text}");
        assert_eq!(catch_panic("nothing", || Ok(4)).expect("no panic"), 4);
    }
}
