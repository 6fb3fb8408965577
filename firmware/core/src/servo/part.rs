//! Parts of the loop that only servo axes need.

/// A part that only a servo axis or an encoder has. Built without the feature `servo`, it has no value: an option of it takes no memory, and
/// the compiler drops all code for one.
#[cfg(feature = "servo")]
pub type ServoPart<T> = T;

#[cfg(not(feature = "servo"))]
pub use absent::ServoPart;

#[cfg(not(feature = "servo"))]
const _: () = assert!(size_of::<Option<ServoPart<u64>>>() == 0);

/// Returns the part of an axis that has one; none where servos are not built in.
pub fn servo_part<T>(part: Option<T>) -> Option<ServoPart<T>> {
    #[cfg(feature = "servo")]
    return part;
    #[cfg(not(feature = "servo"))]
    part.and(None)
}

#[cfg(not(feature = "servo"))]
mod absent {
    use core::convert::Infallible;
    use core::marker::PhantomData;
    use core::ops::{Deref, DerefMut};

    #[derive(Clone, Copy, Debug)]
    pub struct ServoPart<T>(Infallible, PhantomData<T>);

    impl<T> Deref for ServoPart<T> {
        type Target = T;

        fn deref(&self) -> &T {
            match self.0 {}
        }
    }

    impl<T> DerefMut for ServoPart<T> {
        fn deref_mut(&mut self) -> &mut T {
            match self.0 {}
        }
    }
}
