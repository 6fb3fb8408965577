//! A view of a value that another context changes.

use core::cell::Cell;
use core::ptr::NonNull;

use critical_section::{CriticalSection, Mutex};

/// A value that its owner lends, with a `label`, until it changes the value.
///
/// The owner is an interrupt handler. The borrower has a lower priority, so it runs only while the owner does not, and the owner may
/// interrupt it. Interrupts are disabled while the borrower uses the value. So the borrower sees a whole value with its own label, or
/// none.
pub struct Loan<T, L>(Mutex<Cell<Option<Lent<T, L>>>>);

struct Lent<T, L> {
    value: NonNull<T>,
    label: L,
}

// SAFETY: the pointer leads to the value only in `take`, whose caller keeps the owner from running. A label is copied between contexts.
unsafe impl<T: Sync, L: Send> Sync for Loan<T, L> {}

impl<T, L: Copy> Loan<T, L> {
    /// Nothing is lent.
    pub const fn none() -> Self {
        Self(Mutex::new(Cell::new(None)))
    }

    /// Lends a value. This ends the loan before. Called by the owner.
    ///
    /// # Safety
    /// The value must stay at its place, and must not change, until [`Self::end`] or the next loan.
    pub unsafe fn lend(&self, cs: CriticalSection<'_>, value: &T, label: L) {
        let value = NonNull::from(value);
        self.0.borrow(cs).set(Some(Lent { value, label }));
    }

    /// Ends the loan. Called by the owner before it changes the value.
    pub fn end(&self, cs: CriticalSection<'_>) {
        self.0.borrow(cs).set(None);
    }

    /// Ends the loan, and calls `view` with the value and its label. Returns none if nothing was lent. Called by the borrower.
    pub fn take<R>(&self, cs: CriticalSection<'_>, view: impl FnOnce(&T, L) -> R) -> Option<R> {
        let Lent { value, label } = self.0.borrow(cs).take()?;
        // SAFETY: the loan was not ended, so the value is at its place and unchanged. The critical section keeps the owner from running.
        Some(view(unsafe { value.as_ref() }, label))
    }
}
