//! How soon the system lets a thread run.

/// Real-time scheduling where it is allowed, else a nicer place in the queue, else as it is:
/// `sculptd doctor` says which.
pub fn raise_priority() -> &'static str {
    raise(20)
}

/// The same for what serves the loop, one step below it: a journal that waits for its turn loses
/// what a kill finds unwritten.
pub fn raise_priority_below() -> &'static str {
    raise(10)
}

fn raise(level: u8) -> &'static str {
    use thread_priority as tp;
    let fifo = tp::ThreadSchedulePolicy::Realtime(tp::RealtimeThreadSchedulePolicy::Fifo);
    let middle = tp::ThreadPriorityValue::try_from(level).map(tp::ThreadPriority::Crossplatform);
    let Ok(middle) = middle else { return "normal" };
    #[cfg(unix)]
    {
        let id = tp::thread_native_id();
        if tp::unix::set_thread_priority_and_policy(id, middle, fifo).is_ok() {
            return "real-time (SCHED_FIFO)";
        }
    }
    if tp::set_current_thread_priority(tp::ThreadPriority::Max).is_ok() {
        "raised"
    } else {
        "normal"
    }
}
