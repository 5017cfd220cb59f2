//! Accessors: lists of numbers or vectors in a buffer, of any component type, interleaved, normalised or sparse.

use gltf_json::accessor::{ComponentType, Type};
use gltf_json::validation::Checked;

use super::document::Document;
use crate::system::memory;

/// Returns the elements of an accessor as `N` numbers each, or the reason why there are none. Elements of fewer numbers
/// are filled with ones, and further numbers are left out. Normalised integers become shares of 1.
pub(super) fn read<const N: usize>(document: &Document<'_>, index: usize) -> Result<Vec<[f64; N]>, String> {
    let accessor = document.root.accessors.get(index).ok_or_else(|| format!("there is no accessor {index}"))?;
    let wrong = |what: &str| format!("accessor {index} {what}");
    let Checked::Valid(component) = accessor.component_type else { return Err(wrong("has no known component type")) };
    let Checked::Valid(kind) = accessor.type_ else { return Err(wrong("has no known type")) };
    let layout = Layout { component: component.0, width: width(kind), normalised: accessor.normalized };
    let count = usize::try_from(accessor.count.0).map_err(|_| wrong("has too many elements"))?;
    let offset = accessor.byte_offset.map_or(0, |o| o.0);
    // Without a view all are 0 at first. Any view holds as many bytes as it has elements.
    if count > document.bytes() {
        return Err(wrong(&format!("announces {count} elements, more than its buffers have bytes")));
    }
    memory::need("the lists of a glTF model", (count * size_of::<[f64; N]>()) as u64, "take a smaller model")
        .map_err(|e| e.to_string())?;
    let mut list = match accessor.buffer_view {
        Some(view) => elements(document, view.value(), offset, count, layout).map_err(|e| wrong(&e))?,
        None => vec![[0.0; N]; count],
    };
    if let Some(sparse) = &accessor.sparse {
        let Checked::Valid(component) = sparse.indices.component_type else {
            return Err(wrong("has sparse indices of no known type"));
        };
        let changed = usize::try_from(sparse.count.0).unwrap_or(usize::MAX);
        let places = Layout { component: component.0, width: 1, normalised: false };
        let (at, values) = (&sparse.indices, &sparse.values);
        let places: Vec<[f64; 1]> =
            elements(document, at.buffer_view.value(), at.byte_offset.0, changed, places).map_err(|e| wrong(&e))?;
        let values: Vec<[f64; N]> =
            elements(document, values.buffer_view.value(), values.byte_offset.0, changed, layout)
                .map_err(|e| wrong(&e))?;
        for ([place], value) in places.into_iter().zip(values) {
            *list.get_mut(place as usize).ok_or_else(|| wrong("has a sparse index beyond its end"))? = value;
        }
    }
    Ok(list)
}

/// Numbers of an element in a buffer.
#[derive(Clone, Copy, Debug)]
struct Layout {
    component: ComponentType,
    /// Numbers per element.
    width: usize,
    normalised: bool,
}

fn width(kind: Type) -> usize {
    match kind {
        Type::Scalar => 1,
        Type::Vec2 => 2,
        Type::Vec3 => 3,
        Type::Vec4 | Type::Mat2 => 4,
        Type::Mat3 => 9,
        Type::Mat4 => 16,
    }
}

fn elements<const N: usize>(
    document: &Document<'_>,
    view: usize,
    offset: u64,
    count: usize,
    layout: Layout,
) -> Result<Vec<[f64; N]>, String> {
    let (bytes, stride) = document.view(view)?;
    let each = layout.component.size();
    let size = each * layout.width;
    let stride = stride.unwrap_or(size);
    if stride < size {
        return Err(format!("has a stride of {stride} bytes for elements of {size}"));
    }
    if count == 0 {
        return Ok(Vec::new());
    }
    let offset = usize::try_from(offset).unwrap_or(usize::MAX);
    let end = (count - 1).checked_mul(stride).and_then(|l| l.checked_add(size)).and_then(|l| l.checked_add(offset));
    let bytes = end.and_then(|end| bytes.get(offset..end)).ok_or_else(|| {
        format!(
            "has {count} elements of {size} bytes and reaches beyond the {} bytes of buffer view {view}",
            bytes.len()
        )
    })?;
    let element = |i: usize| {
        let mut numbers = [1.0; N];
        for (k, number) in numbers.iter_mut().enumerate().take(layout.width) {
            let at = i * stride + k * each;
            *number = layout.number(&bytes[at..at + each]);
        }
        numbers
    };
    Ok((0..count).map(element).collect())
}

impl Layout {
    /// Returns the number in as many bytes as its type has.
    fn number(self, bytes: &[u8]) -> f64 {
        let mut four = [0; 4];
        four[..bytes.len()].copy_from_slice(bytes);
        let [a, b, ..] = four;
        let (number, most) = match self.component {
            ComponentType::I8 => (f64::from(a as i8), 127.0),
            ComponentType::U8 => (f64::from(a), 255.0),
            ComponentType::I16 => (f64::from(i16::from_le_bytes([a, b])), 32_767.0),
            ComponentType::U16 => (f64::from(u16::from_le_bytes([a, b])), 65_535.0),
            ComponentType::U32 => (f64::from(u32::from_le_bytes(four)), 4_294_967_295.0),
            ComponentType::F32 => return f64::from(f32::from_le_bytes(four)),
        };
        if self.normalised { (number / most).max(-1.0) } else { number }
    }
}
