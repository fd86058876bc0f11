//! Buffers and accessors, and the data or files that a `uri` refers to.

use super::reader::GltfReader;
use crate::range::MAX_NUMBER;
use crate::report::quoted;
use ::gltf::json::accessor::{ComponentType, Type};
use ::gltf::json::validation::Checked;
use ::gltf::json::{Accessor, Index};
use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use std::sync::Arc;

/// Decoder of Base64 with optional padding.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Rows of numbers in a buffer, which are checked to lie within the buffer.
struct AccessorRows {
    bytes: Arc<[u8]>,
    start: usize,
    stride: usize,
    count: usize,
    component: ComponentType,
    is_normalized: bool,
}

impl AccessorRows {
    /// The bytes of a number, with zeros behind them.
    fn word(&self, row: usize, column: usize) -> [u8; 4] {
        let size = self.component.size();
        let at = self.start + row * self.stride + column * size;
        let mut word = [0; 4];
        word[..size].copy_from_slice(&self.bytes[at..at + size]);
        word
    }

    fn number(&self, row: usize, column: usize) -> f64 {
        let word = self.word(row, column);
        let signed = |value: f64, most: f64| match self.is_normalized {
            true => (value / most).max(-1.0),
            false => value,
        };
        match self.component {
            ComponentType::I8 => signed(f64::from(i8::from_le_bytes([word[0]])), 127.0),
            ComponentType::U8 => signed(f64::from(word[0]), 255.0),
            ComponentType::I16 => {
                signed(f64::from(i16::from_le_bytes([word[0], word[1]])), 32_767.0)
            }
            ComponentType::U16 => {
                signed(f64::from(u16::from_le_bytes([word[0], word[1]])), 65_535.0)
            }
            ComponentType::U32 => f64::from(u32::from_le_bytes(word)),
            ComponentType::F32 => f64::from(f32::from_le_bytes(word)),
        }
    }
}

impl GltfReader<'_> {
    /// Returns vectors of N finite numbers, or `None` if a cause of refusal was reported.
    pub(super) fn vectors<T: From<[f64; N]>, const N: usize>(
        &mut self,
        index: Index<Accessor>,
    ) -> Option<Vec<T>> {
        let kind = match N {
            1 => Type::Scalar,
            2 => Type::Vec2,
            _ => Type::Vec3,
        };
        let rows = self.rows(index, kind, N)?;
        self.spend(index, rows.count * N * 8)?;
        let row = |row| std::array::from_fn(|column| rows.number(row, column));
        let numbers: Vec<[f64; N]> = (0..rows.count).map(row).collect();
        let bad = numbers
            .iter()
            .position(|row| !row.iter().all(|v| v.abs() <= MAX_NUMBER));
        if let Some(bad) = bad {
            let message = format!("element {bad} is out of range; allowed: up to {MAX_NUMBER:e}");
            return self.refuse(&format!("accessors[{}]", index.value()), message);
        }
        Some(numbers.into_iter().map(T::from).collect())
    }

    /// Returns indices, or `None` if a cause of refusal was reported.
    pub(super) fn indices(&mut self, index: Index<Accessor>) -> Option<Vec<u32>> {
        let rows = self.rows(index, Type::Scalar, 1)?;
        self.spend(index, rows.count * 4)?;
        use ComponentType::{U8, U16, U32};
        if !matches!(rows.component, U8 | U16 | U32) {
            let path = format!("accessors[{}].componentType", index.value());
            let message = "is not allowed for indices; allowed: 5121, 5123, 5125";
            return self.refuse(&path, message);
        }
        Some(
            (0..rows.count)
                .map(|row| u32::from_le_bytes(rows.word(row, 0)))
                .collect(),
        )
    }

    fn spend(&self, index: Index<Accessor>, bytes: usize) -> Option<()> {
        let path = format!("accessors[{}]", index.value());
        self.accept(&path, self.files.spend(bytes as u64))
    }

    fn rows(&mut self, index: Index<Accessor>, kind: Type, width: usize) -> Option<AccessorRows> {
        let path = format!("accessors[{}]", index.value());
        let accessor = self.root.get(index)?;
        let (Checked::Valid(found), Checked::Valid(component)) =
            (accessor.type_, accessor.component_type)
        else {
            return None;
        };
        if found != kind {
            return self.refuse(&path, format!("has type {found:?}; allowed here: {kind:?}"));
        }
        if accessor.sparse.is_some() {
            return self.refuse(&format!("{path}.sparse"), "is not supported");
        }
        let view = self.root.get(accessor.buffer_view?)?;
        let bytes = self.buffer(view.buffer.value())?;
        let element = component.0.size() * width;
        let stride = view.byte_stride.map_or(element, |stride| stride.0);
        let fit = self.fit(accessor, element, stride, bytes.len());
        let Some((start, count)) = fit else {
            let message = "reaches beyond its buffer, or has elements that overlap";
            return self.refuse(&path, message);
        };
        Some(AccessorRows {
            bytes,
            start,
            stride,
            count,
            component: component.0,
            is_normalized: accessor.normalized,
        })
    }

    /// The offset of the first element and the number of elements, if all elements lie
    /// within their view and the view lies within its buffer.
    fn fit(
        &self,
        accessor: &Accessor,
        element: usize,
        stride: usize,
        length: usize,
    ) -> Option<(usize, usize)> {
        let whole = |value: u64| usize::try_from(value).ok();
        let view = self.root.get(accessor.buffer_view?)?;
        let view_start = whole(view.byte_offset.unwrap_or_default().0)?;
        let view_length = whole(view.byte_length.0)?;
        let within = whole(accessor.byte_offset.unwrap_or_default().0)?;
        let count = whole(accessor.count.0)?;
        let last = count.checked_sub(1)?.checked_mul(stride)?;
        let end = within.checked_add(last)?.checked_add(element)?;
        let fits = end <= view_length && view_start.checked_add(view_length)? <= length;
        (fits && stride >= element).then_some((view_start + within, count))
    }

    /// The bytes of a view, or `None` if a cause of refusal was reported.
    pub(super) fn view(&mut self, number: usize) -> Option<Vec<u8>> {
        let view = self.root.buffer_views.get(number)?;
        let bytes = self.buffer(view.buffer.value())?;
        let whole = |value: u64| usize::try_from(value).ok();
        let start = whole(view.byte_offset.unwrap_or_default().0)?;
        let end = whole(view.byte_length.0).and_then(|length| start.checked_add(length));
        let found = end.and_then(|end| bytes.get(start..end));
        if found.is_none() {
            let path = format!("bufferViews[{number}]");
            self.cause(&path, "reaches beyond its buffer");
        }
        found.map(<[u8]>::to_vec)
    }

    /// The bytes of a buffer, or `None` if a cause of refusal was reported.
    fn buffer(&mut self, number: usize) -> Option<Arc<[u8]>> {
        if let Some(known) = self.buffers.get(&number) {
            return known.clone();
        }
        let read = self.accept(&format!("buffers[{number}]"), self.read_buffer(number));
        self.buffers.insert(number, read.clone());
        read
    }

    fn read_buffer(&self, number: usize) -> Result<Arc<[u8]>, String> {
        let buffer = self.root.buffers.get(number).ok_or("is not there")?;
        let bytes: Arc<[u8]> = match (&buffer.uri, self.chunk) {
            (Some(uri), _) => self.bytes_of(uri)?.into(),
            (None, Some(chunk)) if number == 0 => chunk.into(),
            _ => return Err("has no uri, and the file has no binary chunk".to_owned()),
        };
        let length = usize::try_from(buffer.byte_length.0).ok();
        let within = length.and_then(|length| bytes.get(..length));
        let (found, said) = (bytes.len(), buffer.byte_length.0);
        within
            .map(Arc::from)
            .ok_or_else(|| format!("has {found} bytes, but its byteLength is {said}"))
    }

    /// The bytes that a URI refers to.
    pub(super) fn bytes_of(&self, uri: &str) -> Result<Vec<u8>, String> {
        if let Some(data) = uri.strip_prefix("data:") {
            let bytes = decoded(data, self.files.left())?;
            self.files.spend(bytes.len() as u64)?;
            return Ok(bytes);
        }
        if uri.contains("://") {
            return Err(
                "is the address of a remote file; allowed: local files and data URIs".to_owned(),
            );
        }
        let name = unescaped(uri)?;
        let found = self.files.find(std::slice::from_ref(&self.folder), &name);
        let read = found.and_then(|path| self.files.read(&path));
        read.map_err(|error| format!("file {} {error}", quoted(&name)))
    }
}

/// Decodes the data of a data URI, which may have at most `most` bytes.
fn decoded(data: &str, most: u64) -> Result<Vec<u8>, String> {
    let (kind, text) = data
        .split_once(',')
        .ok_or("is a data URI without a comma")?;
    if !kind.ends_with(";base64") {
        return Err("is a data URI that is not in base64; allowed: base64".to_owned());
    }
    // Four characters of Base64 encode three bytes.
    if (text.len() as u64) / 4 * 3 > most {
        return Err("is a data URI of more bytes than an import may read".to_owned());
    }
    let bytes = BASE64.decode(text);
    bytes.map_err(|error| format!("is a data URI in damaged base64 ({error})"))
}

/// Decodes the percent encoding of a name.
fn unescaped(uri: &str) -> Result<String, String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, after @ ..] = rest {
        let code = after.get(..2).and_then(|two| str::from_utf8(two).ok());
        let code = code.and_then(|two| u8::from_str_radix(two, 16).ok());
        rest = match (first, code) {
            (b'%', Some(byte)) => {
                bytes.push(byte);
                &after[2..]
            }
            _ => {
                bytes.push(*first);
                after
            }
        };
    }
    String::from_utf8(bytes).map_err(|_| "is no UTF-8".to_owned())
}
