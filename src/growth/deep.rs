//! Room for recursion: methods of a model run on a thread with a large stack of its own.

use std::thread::Builder;

/// Stack of the thread that runs a step, in bytes. Only what is used takes memory.
const STACK: usize = 1 << 29;
/// How much of it the model may use; the rest is for the library below.
const USABLE: usize = STACK - (1 << 22);
/// What the model may use of the caller's own stack where there is no such thread.
pub(super) const SHALLOW: usize = 1 << 19;

/// Calls `f` with the number of bytes of stack it may use. It runs on a thread of its own; on the caller's, with little
/// room, if the machine has none to give.
pub(super) fn with_deep_stack<R: Send>(f: impl FnOnce(usize) -> R + Send) -> R {
    let mut slot = Some(f);
    let deep = std::thread::scope(|scope| {
        let f = &mut slot;
        let thread = Builder::new().name("growth".into()).stack_size(STACK);
        let started = thread.spawn_scoped(scope, move || f.take().map(|f| f(USABLE)));
        match started.map(|thread| thread.join()) {
            Ok(Ok(result)) => result,
            Ok(Err(panic)) => std::panic::resume_unwind(panic),
            Err(_) => None,
        }
    });
    match (deep, slot) {
        (Some(result), _) => result,
        (None, Some(f)) => f(SHALLOW),
        (None, None) => unreachable!("`f` is taken only by a thread that gives its result"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_and_panics_come_through() {
        let there =
            with_deep_stack(|bytes| (bytes, std::thread::current().name().map(str::to_owned)));
        assert_eq!(there, (USABLE, Some("growth".to_owned())));
        let caught = std::panic::catch_unwind(|| with_deep_stack(|_| panic!("as expected")));
        assert!(caught.is_err());
    }
}
