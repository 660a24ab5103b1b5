//! Arguments that arrive through C pointers, checked and copied.
//!
//! Arrays are read and written element by element without ever forming a reference to them: an
//! importer may pass overlapping or misaligned ones.
#![allow(unsafe_code, reason = "reads and writes the importer's memory")]

use crate::error::FmiError;
use std::ffi::{CStr, c_char};
use std::marker::PhantomData;

/// Bytes of a C string without its end; null gives none.
///
/// # Safety
/// `text` is null or points to a zero-terminated string that stays unchanged during the call.
#[cfg_attr(small, optimize(size))]
pub(crate) unsafe fn bytes(text: *const c_char) -> Option<Vec<u8>> {
    if text.is_null() {
        return None;
    }
    // SAFETY: not null, the rest is the caller's promise.
    Some(unsafe { CStr::from_ptr(text) }.to_bytes().to_vec())
}

/// [`bytes`] as text; invalid UTF-8 becomes `�`.
///
/// # Safety
/// As [`bytes`].
#[cfg_attr(small, optimize(size))]
pub(crate) unsafe fn text(text: *const c_char) -> Option<String> {
    // SAFETY: the caller's promise.
    Some(String::from_utf8_lossy(&unsafe { bytes(text) }?).into_owned())
}

/// An array that is read.
pub(crate) struct In<'a, T> {
    first: *const T,
    len: usize,
    lifetime: PhantomData<&'a T>,
}

/// An array that is written.
pub(crate) struct Out<'a, T> {
    first: *mut T,
    len: usize,
    lifetime: PhantomData<&'a mut T>,
}

impl<T: Copy> In<'_, T> {
    /// `len` elements from `first`; null is legal for none.
    ///
    /// # Errors
    /// [`FmiError::NullArray`], [`FmiError::Length`].
    ///
    /// # Safety
    /// Unless null, `first` points to `len` elements that can be read during the call.
    pub(crate) unsafe fn new(
        argument: &'static str,
        first: *const T,
        len: usize,
    ) -> Result<Self, FmiError> {
        check::<T>(argument, first.is_null(), len)?;
        Ok(Self {
            first,
            len,
            lifetime: PhantomData,
        })
    }

    /// Number of elements.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Copies all elements to the end of a list.
    pub(crate) fn append_to(&self, list: &mut Vec<T>) {
        if self.len == 0 {
            return;
        }
        list.reserve(self.len);
        let (from, bytes) = (self.first.cast::<u8>(), self.len * size_of::<T>());
        // SAFETY: `len` elements were promised to `new`, and the list has room for as many more.
        // Bytes are copied because the array need not be aligned. `T` is a plain C type.
        unsafe {
            let end = list.as_mut_ptr().add(list.len()).cast::<u8>();
            std::ptr::copy_nonoverlapping(from, end, bytes);
            list.set_len(list.len() + self.len);
        }
    }

    /// An element, if there are so many.
    pub(crate) fn at(&self, index: usize) -> Option<T> {
        (index < self.len).then(|| {
            // SAFETY: `index < len`; the rest was promised to `new`. `T` is a plain C type.
            unsafe { self.first.add(index).read_unaligned() }
        })
    }

    /// Elements from first to last.
    pub(crate) fn iter(&self) -> impl Iterator<Item = T> {
        (0..self.len).map_while(|index| self.at(index))
    }
}

impl<T: Copy> Out<'_, T> {
    /// `len` elements from `first`; null is legal for none.
    ///
    /// # Errors
    /// [`FmiError::NullArray`], [`FmiError::Length`].
    ///
    /// # Safety
    /// Unless null, `first` points to `len` elements that can be written during the call.
    pub(crate) unsafe fn new(
        argument: &'static str,
        first: *mut T,
        len: usize,
    ) -> Result<Self, FmiError> {
        check::<T>(argument, first.is_null(), len)?;
        Ok(Self {
            first,
            len,
            lifetime: PhantomData,
        })
    }

    /// Number of elements.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Writes one element; nothing happens past the end.
    pub(crate) fn set(&mut self, index: usize, value: T) {
        if index < self.len {
            // SAFETY: `index < len`; the rest was promised to `new`.
            unsafe { self.first.add(index).write_unaligned(value) }
        }
    }

    /// Writes elements from the first on, as many as there are in both.
    pub(crate) fn copy(&mut self, values: &[T]) {
        let bytes = self.len.min(values.len()) * size_of::<T>();
        if bytes > 0 {
            let (from, to) = (values.as_ptr().cast::<u8>(), self.first.cast::<u8>());
            // SAFETY: both have so many bytes; of this one `new` was promised it. The caller's
            // array is none of the library's.
            unsafe { std::ptr::copy_nonoverlapping(from, to, bytes) }
        }
    }
}

/// Refuses a null array that should hold something, and a length that no array can have.
fn check<T>(argument: &'static str, null: bool, len: usize) -> Result<(), FmiError> {
    if null && len > 0 {
        return Err(FmiError::NullArray { argument, len });
    }
    if len > isize::MAX as usize / size_of::<T>().max(1) {
        return Err(FmiError::Length { argument, len });
    }
    Ok(())
}

/// A single value that is written.
///
/// # Errors
/// [`FmiError::NullPointer`].
///
/// # Safety
/// Unless null, `place` can be written during the call.
pub(crate) unsafe fn write<T: Copy>(
    argument: &'static str,
    place: *mut T,
    value: T,
) -> Result<(), FmiError> {
    if place.is_null() {
        return Err(FmiError::NullPointer { argument });
    }
    // SAFETY: not null, the rest is the caller's promise.
    unsafe { place.write_unaligned(value) };
    Ok(())
}

/// A single value that is read.
///
/// # Errors
/// [`FmiError::NullPointer`].
///
/// # Safety
/// Unless null, `place` can be read during the call.
pub(crate) unsafe fn read<T: Copy>(argument: &'static str, place: *const T) -> Result<T, FmiError> {
    if place.is_null() {
        return Err(FmiError::NullPointer { argument });
    }
    // SAFETY: not null, the rest is the caller's promise.
    Ok(unsafe { place.read_unaligned() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_null_array_is_legal_only_without_elements() {
        // SAFETY: null is allowed.
        unsafe {
            assert_eq!(
                In::<u32>::new("vr", std::ptr::null(), 0).map(|a| a.iter().count()),
                Ok(0)
            );
            assert_eq!(
                In::<u32>::new("vr", std::ptr::null(), 2).err(),
                Some(FmiError::NullArray {
                    argument: "vr",
                    len: 2
                })
            );
        }
    }

    #[test]
    fn misaligned_arrays_are_read_and_written() {
        let mut memory = [0_u8; 17];
        let first: *mut f64 = memory
            .as_mut_ptr()
            .wrapping_add(1)
            .cast::<std::ffi::c_void>()
            .cast();
        // SAFETY: two doubles fit behind the first byte.
        unsafe {
            let mut array = Out::new("value", first, 2).expect("not null");
            array.set(0, 1.5);
            array.set(1, -2.0);
            array.set(2, 9.0);
            let array = In::new("value", first.cast_const(), 2).expect("not null");
            assert_eq!(array.iter().collect::<Vec<_>>(), [1.5, -2.0]);
            let mut list = vec![0.5];
            array.append_to(&mut list);
            assert_eq!(list, [0.5, 1.5, -2.0]);
            Out::new("value", first, 2).expect("not null").copy(&list);
            assert_eq!(array.iter().collect::<Vec<_>>(), [0.5, 1.5]);
        }
    }

    #[test]
    fn an_impossible_length_is_refused() {
        // SAFETY: the length is checked before anything is read.
        let array = unsafe { In::<f64>::new("value", [0.0].as_ptr(), usize::MAX) };
        assert!(matches!(array.err(), Some(FmiError::Length { .. })));
    }
}
