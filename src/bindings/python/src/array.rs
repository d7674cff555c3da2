//! Arrays between Rust and NumPy.
//!
//! Out: [`shared`] gives NumPy a read-only view of a slice that lives in an `Arc`. The view is
//! described by NumPy's array interface, version 3: an address, a shape and a type. NumPy holds the
//! [`ArrayOwner`], which holds the `Arc`, so the memory outlives every array over it; nothing that
//! is inside an `Arc` here is ever changed.
//!
//! In: [`points`] and [`integers`] read any array-like object. An array of the right type is read
//! in place, everything else is converted by NumPy first.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

use bytemuck::Pod;
use glam::DVec3;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::{PyIndexError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Keeps the memory of shared arrays alive and gives NumPy its address.
#[pyclass(frozen, module = "sculptd._native")]
struct ArrayOwner {
    _owner: Arc<dyn Any + Send + Sync>,
    address: usize,
    shape: Vec<usize>,
    kind: &'static str,
}

impl fmt::Debug for ArrayOwner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ArrayOwner({:?} of {} at {:#x})", self.shape, self.kind, self.address)
    }
}

#[pymethods]
impl ArrayOwner {
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let d = PyDict::new(py);
        d.set_item("version", 3)?;
        d.set_item("data", (self.address, true))?;
        d.set_item("shape", pyo3::types::PyTuple::new(py, &self.shape)?)?;
        d.set_item("typestr", self.kind)?;
        Ok(d)
    }
}

/// NumPy's name of an element type, in the byte order of this machine.
pub trait Element: Pod {
    /// As in `numpy.dtype.str`.
    const KIND: &'static str;
}

macro_rules! elements {
    ($($of:ty: $little:literal $big:literal),+) => {
        $(impl Element for $of {
            const KIND: &'static str = if cfg!(target_endian = "little") { $little } else { $big };
        })+
    };
}

elements!(f64: "<f8" ">f8", f32: "<f4" ">f4", u32: "<u4" ">u4", u8: "|u1" "|u1");

/// Returns a read-only array of `shape` over `slice`, which `owner` keeps alive. Copies no element.
pub fn shared<'py, E: Element>(
    py: Python<'py>,
    owner: Arc<dyn Any + Send + Sync>,
    slice: &[E],
    shape: Vec<usize>,
) -> PyResult<Bound<'py, PyAny>> {
    let numpy = py.import("numpy")?;
    if slice.is_empty() {
        // An empty vector has no address that NumPy accepts.
        return numpy.call_method1("zeros", (pyo3::types::PyTuple::new(py, &shape)?, E::KIND));
    }
    let address = slice.as_ptr() as usize;
    let owner = ArrayOwner { _owner: owner, address, shape, kind: E::KIND };
    numpy.call_method1("asarray", (owner,))
}

/// The points of an (n, 3) array-like object, and whether `what` is finite is for the caller.
pub fn points(object: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<DVec3>> {
    let array = object.py().import("numpy")?.call_method1("ascontiguousarray", (object, "f8"))?;
    let array = array
        .cast::<PyArray2<f64>>()
        .map_err(|_| PyValueError::new_err(format!("{what}: expected an array of shape (n, 3)")))?;
    if array.shape()[1] != 3 {
        let [n, m] = [array.shape()[0], array.shape()[1]];
        return Err(PyValueError::new_err(format!(
            "{what}: expected an array of shape (n, 3), found ({n}, {m})"
        )));
    }
    let read = array.readonly();
    let flat = read.as_slice().map_err(|e| PyValueError::new_err(e.to_string()))?;
    Ok(bytemuck::cast_slice::<f64, DVec3>(flat).to_vec())
}

/// The numbers of an array-like object of integers, in order, each below `limit`; and its shape.
pub fn integers(
    object: &Bound<'_, PyAny>,
    what: &str,
    limit: usize,
) -> PyResult<(Vec<u32>, Vec<usize>)> {
    let numpy = object.py().import("numpy")?;
    let array = numpy.call_method1("asarray", (object,))?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    if kind != "i" && kind != "u" && !shape.contains(&0) {
        return Err(PyTypeError::new_err(format!("{what}: expected integers")));
    }
    let flat = numpy.call_method1("ascontiguousarray", (array, "i8"))?.call_method0("ravel")?;
    let flat = flat.cast::<PyArray1<i64>>()?.readonly();
    let flat = flat.as_slice().map_err(|e| PyValueError::new_err(e.to_string()))?;
    let mut out = Vec::with_capacity(flat.len());
    for (at, &v) in flat.iter().enumerate() {
        match u32::try_from(v) {
            Ok(v) if (v as usize) < limit => out.push(v),
            _ => {
                let at = at / shape.get(1).copied().unwrap_or(1).max(1);
                return Err(PyIndexError::new_err(format!(
                    "{what}: entry {at} is {v}: expected a number from 0 to {}",
                    limit.saturating_sub(1)
                )));
            }
        }
    }
    Ok((out, shape))
}
