//! Keeping freed memory, for work that asks for the same large pieces again and again.

/// Tells the C library to keep what is freed rather than give it back: a training step frees and asks again for a
/// hundred megabytes, and pages that the system hands out anew cost more than many a sum. Does nothing where the
/// allocator is not glibc's.
pub fn keep_pages() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        /// The largest threshold that glibc takes; larger pieces are mapped, and these are kept by [`super::chain`].
        const LARGEST: i32 = 32 << 20;
        #[expect(
            unsafe_code,
            reason = "a C call; with larger pools of buffers it took a step from 25,000 page faults to 8,000"
        )]
        // SAFETY: mallopt takes two numbers, may be called at any time, and refuses what it does not know.
        unsafe {
            libc::mallopt(libc::M_MMAP_THRESHOLD, LARGEST);
            libc::mallopt(libc::M_TRIM_THRESHOLD, i32::MAX);
        }
    }
}
