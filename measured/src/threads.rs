//! The threads that a fit works on: each process has its own, as a child that was forked has none of its parent's.

use crate::FitError;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::cell::Cell;
use std::process::id;
use std::sync::{Arc, RwLock};

thread_local! {
    /// The process in which this thread was started, if it is one of ours; else 0.
    static PROCESS: Cell<u32> = const { Cell::new(0) };
}

/// Does work on the threads of this process, which the first call starts; within such work, in place.
///
/// Work of this crate on several threads uses those of the caller. Without a pool of its own they are the same for the whole
/// program. A child that was forked would wait for them for ever. Libraries that are called from programs that fork work in here.
///
/// # Errors
/// [`FitError::Threads`] where the system refuses threads: the next call asks again. And in a process that was forked by a function
/// that the work has called: its one thread still waits for those of its parent.
///
/// # Examples
/// ```
/// let sum = srbf_measured::in_threads(|| rayon::join(|| 1, || 2))?;
/// assert_eq!(sum, (1, 2));
/// # Ok::<(), srbf_measured::FitError>(())
/// ```
pub fn in_threads<T: Send>(work: impl FnOnce() -> T + Send) -> Result<T, FitError> {
    match PROCESS.get() {
        0 => Ok(pool()?.install(work)),
        process if process == id() => Ok(work()),
        _ => Err(FitError::Threads("no fit in a process that was forked within a fit".into())),
    }
}

/// The threads of this process. Nobody waits for the lock: one that a thread of the parent holds at a fork stays locked in the child,
/// which then starts threads for each work.
fn pool() -> Result<Arc<ThreadPool>, FitError> {
    static POOL: RwLock<Option<(u32, Arc<ThreadPool>)>> = RwLock::new(None);
    if let Ok(held) = POOL.try_read()
        && let Some((process, pool)) = &*held
        && *process == id()
    {
        return Ok(pool.clone());
    }
    let made = ThreadPoolBuilder::new().start_handler(|_| PROCESS.set(id())).build();
    let made = made.map_err(|error| FitError::Threads(format!("no threads to work on: {error}")))?;
    let pool = Arc::new(made);
    if let Ok(mut held) = POOL.try_write() {
        let old = held.replace((id(), pool.clone()));
        // The parent's are left alone: to end them would wait for threads that are not there.
        if old.as_ref().is_some_and(|(process, _)| *process != id()) {
            std::mem::forget(old);
        }
    }
    Ok(pool)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_done_on_threads_of_our_own_and_within_it_in_place() {
        let thread = || std::thread::current().id();
        let (outer, inner) = in_threads(|| (thread(), in_threads(thread).unwrap())).unwrap();
        assert!(outer == inner && outer != thread());
        // As in a child that was forked there.
        let forked = in_threads(|| {
            let own = PROCESS.replace(1);
            let refused = in_threads(|| ());
            PROCESS.set(own);
            refused
        });
        let error = forked.unwrap().unwrap_err().to_string();
        assert!(error.contains("forked within a fit"), "{error}");
    }
}
