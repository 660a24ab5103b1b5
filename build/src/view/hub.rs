//! The viewers: what is sent to each, and what each sends.

use super::socket::{Kind, frame};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};

/// Frames that wait for a viewer; one that takes them more slowly misses some.
const WAITING: usize = 8;

/// A frame, made once for all viewers.
pub type Bytes = Arc<Vec<u8>>;

#[derive(Debug)]
struct Viewer {
    id: u64,
    queue: SyncSender<Bytes>,
    /// Whether it must be told everything, because it is new or has missed news.
    stale: bool,
}

/// All viewers.
#[derive(Clone, Debug, Default)]
pub struct Hub {
    viewers: Arc<Mutex<Vec<Viewer>>>,
}

impl Hub {
    /// A new viewer; gives what is to be sent to it.
    pub fn join(&self, id: u64) -> (SyncSender<Bytes>, Receiver<Bytes>) {
        let (queue, frames) = sync_channel(WAITING);
        let viewer = Viewer {
            id,
            queue: queue.clone(),
            stale: true,
        };
        self.lock().push(viewer);
        (queue, frames)
    }

    /// A viewer has gone.
    pub fn leave(&self, id: u64) {
        self.lock().retain(|viewer| viewer.id != id);
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.lock().len()
    }

    /// Sends values; who has no place for them misses them. Never waits.
    pub fn send_values(&self, values: &[u8]) {
        let bytes = Arc::new(frame(Kind::Binary, values));
        self.lock().retain(|viewer| {
            !matches!(
                viewer.queue.try_send(bytes.clone()),
                Err(TrySendError::Disconnected(_))
            )
        });
    }

    /// Sends news: `changes` to those who know all else, `everything` to the others.
    pub fn send_news(&self, changes: Option<String>, everything: impl Fn() -> String) {
        let packed = |text: String| Arc::new(frame(Kind::Text, text.as_bytes()));
        let changes = changes.map(packed);
        let mut all = None;
        for viewer in self.lock().iter_mut() {
            let bytes = match (&changes, viewer.stale) {
                (_, true) => all.get_or_insert_with(|| packed(everything())),
                (Some(changes), false) => changes,
                (None, false) => continue,
            };
            viewer.stale = viewer.queue.try_send(bytes.clone()).is_err();
        }
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Vec<Viewer>> {
        // A thread that panicked left a list that is whole all the same.
        self.viewers.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_viewer_that_takes_nothing_holds_up_nobody_and_is_told_all_later() {
        let hub = Hub::default();
        let (_stuck, stuck) = hub.join(1);
        let (_quick, quick) = hub.join(2);
        for i in 0..100 {
            hub.send_values(&[i]);
            assert_eq!(quick.try_recv().map(|frame| frame[2]), Ok(i));
        }
        // The stuck one is full, so that news do not reach it.
        hub.send_news(Some("changes".to_owned()), || "everything".to_owned());
        assert_eq!(stuck.try_iter().count(), WAITING);
        hub.send_news(None, || "everything".to_owned());
        let text = |frame: Bytes| String::from_utf8_lossy(&frame[2..]).into_owned();
        assert_eq!(
            stuck.try_iter().map(text).collect::<Vec<_>>(),
            ["everything"]
        );
        assert_eq!(
            quick.try_iter().map(text).collect::<Vec<_>>(),
            ["everything"]
        );
        hub.send_news(Some("changes".to_owned()), || "everything".to_owned());
        assert_eq!(stuck.try_iter().map(text).collect::<Vec<_>>(), ["changes"]);
    }

    #[test]
    fn who_is_gone_is_forgotten() {
        let hub = Hub::default();
        drop(hub.join(1));
        let _kept = hub.join(2);
        hub.send_values(&[0]);
        assert_eq!(hub.count(), 1);
        hub.leave(2);
        assert_eq!(hub.count(), 0);
    }
}
