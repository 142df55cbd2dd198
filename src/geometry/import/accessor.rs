//! Numbers out of the buffers of a glTF document, every step of the way checked.

use super::{ImportError, Room};
use gltf_json::accessor::{Accessor, ComponentType, Type};
use gltf_json::validation::Checked;
use gltf_json::{Index, Root};

/// A document and the bytes of its buffers.
pub(super) struct Document {
    pub(super) root: Root,
    pub(super) buffers: Vec<Vec<u8>>,
}

/// The bytes of an accessor, and how they are laid out.
struct Layout<'d> {
    bytes: &'d [u8],
    component: ComponentType,
    is_normalized: bool,
    n_components: usize,
    /// Bytes from one element to the next, at least the size of one.
    stride: usize,
    count: usize,
}

fn broken(index: usize, what: &str) -> ImportError {
    ImportError::Broken(format!("its accessor {index} {what}"))
}

impl Document {
    /// The bytes of a view.
    pub(super) fn view(&self, index: Index<gltf_json::buffer::View>) -> Result<&[u8], ImportError> {
        let find = || {
            let view = self.root.get(index)?;
            let buffer = self.buffers.get(view.buffer.value())?;
            let start = usize::try_from(view.byte_offset.map_or(0, |offset| offset.0)).ok()?;
            let end = start.checked_add(usize::try_from(view.byte_length.0).ok()?)?;
            buffer.get(start..end)
        };
        find().ok_or_else(|| {
            ImportError::Broken(format!(
                "its buffer view {} is outside of its buffer",
                index.value()
            ))
        })
    }

    /// The elements of an accessor as floats, `N` each.
    pub(super) fn floats<const N: usize>(
        &self,
        index: Index<Accessor>,
        wanted: Type,
        room: &mut Room,
    ) -> Result<Vec<[f64; N]>, ImportError> {
        let layout = self.layout(index, wanted)?;
        room.take(layout.count as u64, size_of::<[f64; N]>())?;
        let element = |i: usize| std::array::from_fn(|k| layout.float(i, k));
        Ok((0..layout.count).map(element).collect())
    }

    /// The elements of an accessor as indices.
    pub(super) fn indices(
        &self,
        index: Index<Accessor>,
        room: &mut Room,
    ) -> Result<Vec<u32>, ImportError> {
        let layout = self.layout(index, Type::Scalar)?;
        if !matches!(
            layout.component,
            ComponentType::U8 | ComponentType::U16 | ComponentType::U32
        ) {
            return Err(broken(index.value(), "holds no indices"));
        }
        room.take(layout.count as u64, size_of::<u32>())?;
        Ok((0..layout.count)
            .map(|i| layout.float(i, 0) as u32)
            .collect())
    }

    fn layout(&self, index: Index<Accessor>, wanted: Type) -> Result<Layout<'_>, ImportError> {
        let at = index.value();
        let accessor = self
            .root
            .get(index)
            .ok_or_else(|| broken(at, "does not exist"))?;
        if accessor.sparse.is_some() {
            return Err(broken(at, "is sparse, which is not read"));
        }
        let (Checked::Valid(component), Checked::Valid(kind)) =
            (accessor.component_type, accessor.type_)
        else {
            return Err(broken(at, "is of an unknown type"));
        };
        if kind != wanted {
            return Err(broken(
                at,
                &format!("holds {kind:?} where {wanted:?} is needed"),
            ));
        }
        let view = accessor
            .buffer_view
            .ok_or_else(|| broken(at, "has no bytes"))?;
        let component = component.0;
        let n_components = wanted.multiplicity();
        let size = component.size() * n_components;
        let stride = self.root.get(view).and_then(|view| view.byte_stride);
        let stride = stride.map_or(size, |stride| stride.0);
        if stride < size {
            return Err(broken(at, "has elements that lie over each other"));
        }
        let count = usize::try_from(accessor.count.0).unwrap_or(usize::MAX);
        let offset = usize::try_from(accessor.byte_offset.map_or(0, |offset| offset.0)).ok();
        let bytes = offset.and_then(|offset| self.view(view).ok()?.get(offset..));
        let bytes = bytes.ok_or_else(|| broken(at, "is outside of its buffer"))?;
        // The last element need not fill its stride.
        let needed = count
            .saturating_sub(1)
            .checked_mul(stride)
            .and_then(|n| n.checked_add(size));
        if count > 0 && needed.is_none_or(|needed| needed > bytes.len()) {
            return Err(broken(
                at,
                &format!("names {count} elements, more than its buffer holds"),
            ));
        }
        Ok(Layout {
            bytes,
            component,
            is_normalized: accessor.normalized,
            n_components,
            stride,
            count,
        })
    }
}

impl Layout<'_> {
    /// Component `k` of element `i`, which must be there.
    fn float(&self, i: usize, k: usize) -> f64 {
        debug_assert!(
            i < self.count && k < self.n_components,
            "invariant: within the accessor"
        );
        let at = i * self.stride + k * self.component.size();
        let four: [u8; 4] = std::array::from_fn(|b| self.bytes.get(at + b).copied().unwrap_or(0));
        let two = [four[0], four[1]];
        let (value, most) = match self.component {
            ComponentType::I8 => (f64::from(four[0] as i8), 127.0),
            ComponentType::U8 => (f64::from(four[0]), 255.0),
            ComponentType::I16 => (f64::from(i16::from_le_bytes(two)), 32767.0),
            ComponentType::U16 => (f64::from(u16::from_le_bytes(two)), 65535.0),
            ComponentType::U32 => (f64::from(u32::from_le_bytes(four)), 4_294_967_295.0),
            ComponentType::F32 => return f64::from(f32::from_le_bytes(four)),
        };
        if self.is_normalized {
            (value / most).max(-1.0)
        } else {
            value
        }
    }
}
