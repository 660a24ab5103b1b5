//! Work on many things at a time, for what is done once: reading files, packing meshes, pictures.
//!
//! Results stand in the order of the things, so that they do not depend on the number of threads.
//! A step of the simulation has no threads.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Threads, at most: more than these wait for memory.
const MOST: usize = 8;

/// How many threads share the work.
pub fn workers() -> usize {
    std::thread::available_parallelism().map_or(1, |n| n.get().min(MOST))
}

/// What `work` makes of each thing.
pub fn map<T: Sync, R: Send>(things: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let workers = workers().min(things.len());
    if workers <= 1 {
        return things.iter().map(work).collect();
    }
    let next = AtomicUsize::new(0);
    let mut results: Vec<(usize, R)> = std::thread::scope(|scope| {
        let worker = || {
            let mut own = Vec::new();
            loop {
                let i = next.fetch_add(1, Ordering::Relaxed);
                let Some(thing) = things.get(i) else {
                    return own;
                };
                own.push((i, work(thing)));
            }
        };
        let threads: Vec<_> = (1..workers).map(|_| scope.spawn(worker)).collect();
        let mut all = worker();
        for thread in threads {
            match thread.join() {
                Ok(own) => all.extend(own),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        all
    });
    results.sort_unstable_by_key(|(i, _)| *i);
    results.into_iter().map(|(_, result)| result).collect()
}

/// The same, the largest first, so that none of them is begun when all else is done.
pub fn map_largest_first<T: Sync, R: Send>(
    things: &[T],
    size: impl Fn(&T) -> usize,
    work: impl Fn(&T) -> R + Sync,
) -> Vec<R> {
    let mut order: Vec<usize> = (0..things.len()).collect();
    order.sort_by_key(|&i| std::cmp::Reverse(size(&things[i])));
    let results = map(&order, |&i| work(&things[i]));
    let mut results: Vec<(usize, R)> = order.into_iter().zip(results).collect();
    results.sort_unstable_by_key(|(i, _)| *i);
    results.into_iter().map(|(_, result)| result).collect()
}

/// Gives each piece of a list to `work`, with the piece's number; all but the last have `size`.
pub fn for_pieces<T: Send>(list: &mut [T], size: usize, work: impl Fn(usize, &mut [T]) + Sync) {
    let next = Mutex::new(list.chunks_mut(size.max(1)).enumerate());
    std::thread::scope(|scope| {
        let worker = || {
            loop {
                // A worker that was stopped by a panic leaves the list as it was.
                let taken = next.lock().unwrap_or_else(PoisonError::into_inner).next();
                let Some((i, piece)) = taken else { break };
                work(i, piece);
            }
        };
        for _ in 1..workers() {
            scope.spawn(worker);
        }
        worker();
    });
}

/// What two pieces of work give that do not need each other.
pub fn both<A: Send, B>(one: impl FnOnce() -> A + Send, other: impl FnOnce() -> B) -> (A, B) {
    std::thread::scope(|scope| {
        let one = scope.spawn(one);
        let other = other();
        match one.join() {
            Ok(one) => (one, other),
            Err(panic) => std::panic::resume_unwind(panic),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::{both, for_pieces, map, map_largest_first};

    #[test]
    fn each_piece_is_worked_on_once() {
        let mut list = [0; 1003];
        for_pieces(&mut list, 10, |i, piece| {
            for x in piece {
                *x += i;
            }
        });
        assert!(list.iter().enumerate().all(|(k, x)| *x == k / 10));
        for_pieces(&mut [0; 0], 10, |_, _| panic!("there is nothing"));
        assert_eq!(both(|| 1, || "two"), (1, "two"));
    }

    #[test]
    fn results_stand_in_the_order_of_the_things() {
        for count in [0, 1, 2, 1000] {
            let things: Vec<usize> = (0..count).collect();
            let squares: Vec<usize> = things.iter().map(|i| i * i).collect();
            assert_eq!(map(&things, |i| i * i), squares);
            let size = |i: &usize| i * 7 % 11;
            assert_eq!(map_largest_first(&things, size, |i| i * i), squares);
        }
    }

    #[test]
    #[should_panic(expected = "the seventh")]
    fn a_panic_in_one_thread_is_passed_on() {
        map(&[0; 20], |_| ());
        map(&(0..20).collect::<Vec<_>>(), |i| {
            assert!(*i != 7, "the seventh");
        });
    }
}
