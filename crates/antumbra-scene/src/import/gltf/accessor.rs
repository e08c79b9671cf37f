//! Typed views of buffers. Counts, offsets and strides are checked once, against the bytes that are there; then every
//! element can be read.

use super::{File, label};
use crate::SceneError;
use gltf_json::accessor::{ComponentType, GenericComponentType, IndexComponentType, Type};
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Index};

/// Elements of an accessor.
pub(super) struct Elements<'a> {
    /// How many there are.
    pub count: usize,
    component: ComponentType,
    normalized: bool,
    /// `None` where all elements are zero but for the sparse ones.
    dense: Option<Strided<'a>>,
    sparse: Option<Sparse<'a>>,
}

/// Elements at a constant distance from each other.
struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
}

/// Elements that replace some of the dense ones, sorted by number.
struct Sparse<'a> {
    numbers: Vec<u32>,
    values: Strided<'a>,
}

impl<'a> File<'a> {
    /// Elements of `N` components each (1 to 4, or 16 for a matrix), of a component type that `accept` allows.
    pub fn elements<const N: usize>(
        &self,
        index: Index<Accessor>,
        accept: fn(ComponentType) -> bool,
        place: &str,
    ) -> Result<Elements<'a>, SceneError> {
        let accessor = self.get(&self.root.accessors, index, "accessors", place)?;
        let place = format!("{place}, {}", label("accessor", index.value(), &accessor.name));
        let component = match accessor.component_type {
            Checked::Valid(GenericComponentType(c)) if accept(c) => c,
            _ => return Err(self.malformed(place, "its componentType is not one that is allowed here")),
        };
        let expected = match N {
            1 => Type::Scalar,
            2 => Type::Vec2,
            3 => Type::Vec3,
            4 => Type::Vec4,
            _ => Type::Mat4,
        };
        if accessor.type_ != Checked::Valid(expected) {
            return Err(self.malformed(place, format!("its type should be {expected:?} here")));
        }
        let count = self.count(accessor.count.0, &place)?;
        let size = component.size() * N;
        let dense = match accessor.buffer_view {
            None => None,
            Some(view) => {
                let (bytes, stride) = self.view(view, &place)?;
                let offset = accessor.byte_offset.unwrap_or_default().0;
                Some(self.strided(bytes, offset, stride.unwrap_or(size), size, count, &place)?)
            }
        };
        if dense.is_none() && count > self.buffers.total() {
            return Err(self.truncated(
                place,
                "the accessor, which has no bufferView,",
                count as u128,
                self.buffers.total(),
            ));
        }
        let sparse = accessor.sparse.as_ref().map(|s| self.sparse(s, size, count, &place)).transpose()?;
        Ok(Elements { count, component, normalized: accessor.normalized, dense, sparse })
    }

    /// A count that vertex numbers of 32 bits can reach.
    fn count(&self, count: u64, place: &str) -> Result<usize, SceneError> {
        u32::try_from(count)
            .map(|c| c as usize)
            .map_err(|_| self.malformed(place, format!("it claims {count} elements, more than can be numbered")))
    }

    fn strided(
        &self,
        bytes: &'a [u8],
        offset: u64,
        stride: usize,
        size: usize,
        count: usize,
        place: &str,
    ) -> Result<Strided<'a>, SceneError> {
        if stride < size {
            let problem = format!("its elements of {size} bytes are only {stride} bytes apart");
            return Err(self.malformed(place, problem));
        }
        if count == 0 {
            return Ok(Strided { bytes: &[], stride });
        }
        let needed = u128::from(offset) + (count as u128 - 1) * stride as u128 + size as u128;
        if needed > bytes.len() as u128 {
            return Err(self.truncated(
                place.to_string(),
                &format!("the accessor's {count} elements"),
                needed,
                bytes.len(),
            ));
        }
        Ok(Strided { bytes: &bytes[offset as usize..], stride })
    }

    fn sparse(
        &self,
        sparse: &gltf_json::accessor::sparse::Sparse,
        size: usize,
        count: usize,
        place: &str,
    ) -> Result<Sparse<'a>, SceneError> {
        let place = format!("{place}, sparse");
        let Checked::Valid(IndexComponentType(component)) = sparse.indices.component_type else {
            return Err(self.malformed(place, "the indices' componentType is not that of an index"));
        };
        let replaced = self.count(sparse.count.0, &place)?;
        let (bytes, _) = self.view(sparse.indices.buffer_view, &place)?;
        let width = component.size();
        let numbers = self.strided(bytes, sparse.indices.byte_offset.0, width, width, replaced, &place)?;
        let (bytes, _) = self.view(sparse.values.buffer_view, &place)?;
        let values = self.strided(bytes, sparse.values.byte_offset.0, size, size, replaced, &place)?;
        let numbers: Vec<u32> = (0..replaced).map(|i| numbers.integer(i, component)).collect();
        let increasing = numbers.windows(2).all(|w| w[0] < w[1]);
        if !increasing || numbers.last().is_some_and(|&last| last as usize >= count) {
            return Err(self.malformed(place, format!("its indices must increase and stay below {count}")));
        }
        Ok(Sparse { numbers, values })
    }
}

impl Elements<'_> {
    /// The components of element `i`, which is below `count`.
    pub fn floats<const N: usize>(&self, i: usize) -> [f32; N] {
        match self.find(i) {
            None => [0.0; N],
            Some((elements, i)) => std::array::from_fn(|c| elements.float(i, c, self.component, self.normalized)),
        }
    }

    /// Element `i` of an accessor of integers; `i` is below `count`.
    pub fn integer(&self, i: usize) -> u32 {
        self.find(i).map_or(0, |(elements, i)| elements.integer(i, self.component))
    }

    /// Where element `i` lies.
    fn find(&self, i: usize) -> Option<(&Strided<'_>, usize)> {
        let replaced = self.sparse.as_ref().and_then(|s| {
            let k = s.numbers.binary_search(&(i as u32)).ok()?;
            Some((&s.values, k))
        });
        replaced.or_else(|| Some((self.dense.as_ref()?, i)))
    }
}

impl Strided<'_> {
    fn bytes<const B: usize>(&self, element: usize, component: usize) -> [u8; B] {
        let at = element * self.stride + component * B;
        self.bytes[at..at + B].try_into().expect("a range of B bytes")
    }

    fn integer(&self, i: usize, component: ComponentType) -> u32 {
        match component.size() {
            1 => self.bytes::<1>(i, 0)[0].into(),
            2 => u16::from_le_bytes(self.bytes(i, 0)).into(),
            _ => u32::from_le_bytes(self.bytes(i, 0)),
        }
    }

    fn float(&self, i: usize, c: usize, component: ComponentType, normalized: bool) -> f32 {
        let (value, one) = match component {
            ComponentType::F32 => return f32::from_le_bytes(self.bytes(i, c)),
            ComponentType::I8 => (i8::from_le_bytes(self.bytes(i, c)).into(), 127.0),
            ComponentType::U8 => (u8::from_le_bytes(self.bytes(i, c)).into(), 255.0),
            ComponentType::I16 => (i16::from_le_bytes(self.bytes(i, c)).into(), 32767.0),
            ComponentType::U16 => (u16::from_le_bytes(self.bytes(i, c)).into(), 65535.0),
            ComponentType::U32 => (u32::from_le_bytes(self.bytes(i, c)) as f32, 4294967295.0),
        };
        if normalized { f32::max(value / one, -1.0) } else { value }
    }
}
