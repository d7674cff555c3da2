//! The operators of a `.tflite` model, with their weights in single precision.
//!
//! Thirteen operators are known: those of the four hand models. Weights in half precision are
//! widened when the model is loaded, so DEQUANTIZE never runs.

use super::flatbuffer::{FlatTable, ModelError};

/// Height, width and channels of a picture-like tensor, or the length of a flat one in `c`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TensorShape {
    /// Rows.
    pub h: usize,
    /// Columns.
    pub w: usize,
    /// Channels, which are adjacent in memory.
    pub c: usize,
}

impl TensorShape {
    /// Returns the number of elements.
    pub fn count(self) -> usize {
        self.h * self.w * self.c
    }
}

/// Range to which an operator's results are clamped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutputRange(pub f32, pub f32);

impl OutputRange {
    /// No clamping.
    pub const ALL: OutputRange = OutputRange(f32::MIN, f32::MAX);
}

/// Window of a convolution or a pooling.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// Height and width.
    pub size: (usize, usize),
    /// Step down and across.
    pub stride: (usize, usize),
    /// Zero rows above and columns left of the input.
    pub pad: (usize, usize),
}

/// An operator of the graph; numbers are tensors.
#[derive(Debug, Clone, PartialEq)]
pub enum Operator {
    /// Weights are `[output][row][column][input]`.
    Convolution { window: Window, weights: Vec<f32>, bias: Vec<f32>, range: OutputRange },
    /// Weights are `[row][column][channel]`.
    Depthwise { window: Window, weights: Vec<f32>, bias: Vec<f32>, range: OutputRange },
    /// One slope a channel for negative values.
    Prelu { slopes: Vec<f32> },
    /// Sum of two tensors of one shape.
    Sum { range: OutputRange },
    /// Channels filled up with zeros.
    PadChannels,
    /// Largest value of each window.
    MaxPool { window: Window },
    /// Bilinear enlargement with half-pixel centres.
    Resize,
    /// The same numbers in another shape.
    Reshape,
    /// Inputs one after the other.
    Concatenate,
    /// Mean over rows and columns.
    Mean,
    /// Logistic function.
    Logistic,
}

/// One operator with the tensors that it reads and writes.
#[derive(Debug, Clone, PartialEq)]
pub struct GraphNode {
    /// The operator and its weights.
    pub operator: Operator,
    /// Tensors read.
    pub inputs: Vec<usize>,
    /// Tensor written.
    pub output: usize,
}

/// A model: operators in the order in which they run.
#[derive(Debug, Clone, PartialEq)]
pub struct Graph {
    /// Shape of each tensor.
    pub shapes: Vec<TensorShape>,
    /// Operators in order.
    pub nodes: Vec<GraphNode>,
    /// The input tensor.
    pub input: usize,
    /// The output tensors.
    pub outputs: Vec<usize>,
}

/// Most elements of one tensor: far more than a hand model has.
const MAX_TENSOR: usize = 1 << 24;

struct Loader<'a> {
    tensors: Vec<FlatTable<'a>>,
    buffers: Vec<FlatTable<'a>>,
    shapes: Vec<TensorShape>,
    /// Source of each tensor that DEQUANTIZE writes.
    widened: Vec<Option<usize>>,
}

/// Reads a model.
///
/// # Errors
/// Returns an error if the file is damaged or uses an operator that is not known.
pub fn parse(bytes: &[u8]) -> Result<Graph, ModelError> {
    let model = FlatTable::root(bytes)?;
    let codes: Vec<i32> = model
        .tables(1)?
        .iter()
        .map(|t| Ok(t.int(3, 0)?.max(i32::from(t.byte(0)?))))
        .collect::<Result<_, ModelError>>()?;
    let graphs = model.tables(2)?;
    let [graph] = graphs.as_slice() else {
        return Err(ModelError::Unsupported(format!("a model of {} graphs", graphs.len())));
    };
    let tensors = graph.tables(0)?;
    let shapes = tensors.iter().map(shape_of).collect::<Result<Vec<_>, _>>()?;
    let widened = vec![None; tensors.len()];
    let mut loader = Loader { tensors, buffers: model.tables(4)?, shapes, widened };
    let mut nodes = Vec::new();
    for op in graph.tables(3)? {
        let code = codes.get(op.int(0, 0)? as usize).copied().unwrap_or(-1);
        nodes.extend(loader.node(code, &op)?);
    }
    let index = |list: Vec<i32>| -> Result<Vec<usize>, ModelError> {
        list.into_iter().map(|i| loader.index(i)).collect()
    };
    let inputs = index(graph.ints(1)?)?;
    let outputs = index(graph.ints(2)?)?;
    let [input] = inputs.as_slice() else {
        return Err(ModelError::Unsupported(format!("a model of {} inputs", inputs.len())));
    };
    Ok(Graph { input: *input, outputs, nodes, shapes: loader.shapes })
}

fn shape_of(tensor: &FlatTable<'_>) -> Result<TensorShape, ModelError> {
    let sides: Vec<usize> = tensor
        .ints(0)?
        .iter()
        .map(|n| usize::try_from(*n).map_err(|_| ModelError::Inconsistent(format!("side {n}"))))
        .collect::<Result<_, _>>()?;
    let shape = match sides.as_slice() {
        [] => TensorShape { h: 1, w: 1, c: 1 },
        [c] => TensorShape { h: 1, w: 1, c: *c },
        [w, c] => TensorShape { h: 1, w: *w, c: *c },
        [h, w, c] => TensorShape { h: *h, w: *w, c: *c },
        [n, h, w, c] => TensorShape { h: n.saturating_mul(*h), w: *w, c: *c },
        more => return Err(ModelError::Unsupported(format!("a tensor of {} sides", more.len()))),
    };
    let size = shape.h.checked_mul(shape.w).and_then(|n| n.checked_mul(shape.c));
    match size {
        Some(n) if n <= MAX_TENSOR => Ok(shape),
        _ => Err(ModelError::Unsupported(format!("a tensor of {sides:?}"))),
    }
}

/// Widens a number of half precision.
fn half_to_single(bits: u16) -> f32 {
    let (sign, exponent, fraction) =
        (u32::from(bits >> 15) << 31, u32::from(bits >> 10) & 31, u32::from(bits) & 1023);
    match exponent {
        // Subnormal: the fraction in units of 2^-24.
        0 => {
            let value = fraction as f32 / 16_777_216.0;
            if sign > 0 { -value } else { value }
        }
        31 => f32::from_bits(sign | 0x7f80_0000 | fraction << 13),
        e => f32::from_bits(sign | (e + 112) << 23 | fraction << 13),
    }
}

impl Loader<'_> {
    fn index(&self, i: i32) -> Result<usize, ModelError> {
        let index = usize::try_from(i).ok().filter(|i| *i < self.tensors.len());
        index.ok_or_else(|| ModelError::Inconsistent(format!("there is no tensor {i}")))
    }

    /// Returns the constant numbers of a tensor.
    fn numbers(&self, tensor: usize) -> Result<Vec<f32>, ModelError> {
        let tensor = self.widened[tensor].unwrap_or(tensor);
        let table = self.tensors[tensor];
        let buffer = self.buffers.get(table.int(2, 0)? as usize);
        let bytes = match buffer {
            Some(buffer) => buffer.bytes(0)?,
            None => &[],
        };
        let numbers: Vec<f32> = match table.byte(1)? {
            0 => bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect(),
            1 => bytes
                .as_chunks::<2>()
                .0
                .iter()
                .map(|b| half_to_single(u16::from_le_bytes(*b)))
                .collect(),
            other => return Err(ModelError::Unsupported(format!("tensor type {other}"))),
        };
        let expected = self.shapes[tensor].count();
        if numbers.len() != expected {
            return Err(ModelError::Inconsistent(format!(
                "tensor {tensor} has {} numbers instead of {expected}",
                numbers.len()
            )));
        }
        Ok(numbers)
    }

    /// Returns the operator's node; `None` for DEQUANTIZE, which is applied here.
    fn node(&mut self, code: i32, op: &FlatTable<'_>) -> Result<Option<GraphNode>, ModelError> {
        let list = |ints: Vec<i32>| -> Result<Vec<usize>, ModelError> {
            ints.into_iter().map(|i| self.index(i)).collect()
        };
        let (inputs, outputs) = (list(op.ints(1)?)?, list(op.ints(2)?)?);
        let ([first, ..], [output]) = (inputs.as_slice(), outputs.as_slice()) else {
            return Err(ModelError::Inconsistent("an operator without input or output".into()));
        };
        let (first, output) = (*first, *output);
        if code == 6 {
            self.widened[output] = Some(first);
            return Ok(None);
        }
        let options = op.table(4)?;
        let second = || {
            let missing = || ModelError::Inconsistent("an operator without weights".into());
            inputs.get(1).copied().ok_or_else(missing)
        };
        let int = |index, default| options.map_or(Ok(default), |o| o.int(index, default));
        let byte = |index| options.map_or(Ok(0), |o| o.byte(index));
        let (operator, reads) = match code {
            0 => (Operator::Sum { range: range_of(byte(0)?)? }, inputs.clone()),
            2 => (Operator::Concatenate, inputs.clone()),
            3 | 4 => {
                let depthwise = code == 4;
                let act = byte(if depthwise { 4 } else { 3 })?;
                let kernel = self.shapes[second()?];
                if int(if depthwise { 5 } else { 4 }, 1)? != 1 {
                    return Err(ModelError::Unsupported("a dilated convolution".into()));
                }
                let outputs = self.shapes[output].c;
                // Rows of the kernel are folded with the output channels in `shape_of`.
                let rows = if depthwise { kernel.h } else { kernel.h / outputs.max(1) };
                let stride = (int(2, 1)?, int(1, 1)?);
                let window = self.window((rows, kernel.w), stride, byte(0)?, first)?;
                let (weights, range) = (self.numbers(second()?)?, range_of(act)?);
                let bias = match inputs.get(2) {
                    Some(bias) => self.numbers(*bias)?,
                    None => vec![0.0; outputs],
                };
                let operator = if depthwise {
                    Operator::Depthwise { window, weights, bias, range }
                } else {
                    Operator::Convolution { window, weights, bias, range }
                };
                (operator, vec![first])
            }
            9 => {
                let (weights, range) = (self.numbers(second()?)?, range_of(byte(0)?)?);
                let bias = match inputs.get(2) {
                    Some(bias) => self.numbers(*bias)?,
                    None => vec![0.0; self.shapes[output].c],
                };
                let window = Window { size: (1, 1), stride: (1, 1), pad: (0, 0) };
                // A full connection is a convolution of one pixel.
                let c = self.shapes[first].count();
                self.shapes[first] = TensorShape { h: 1, w: 1, c };
                (Operator::Convolution { window, weights, bias, range }, vec![first])
            }
            14 => (Operator::Logistic, vec![first]),
            17 => {
                let stride = (int(2, 1)?, int(1, 1)?);
                let size = (int(4, 1)?.max(1) as usize, int(3, 1)?.max(1) as usize);
                let window = self.window(size, stride, byte(0)?, first)?;
                (Operator::MaxPool { window }, vec![first])
            }
            22 => (Operator::Reshape, vec![first]),
            23 => {
                let flags = (byte(2)?, byte(3)?);
                if flags != (0, 1) {
                    let text = format!("a resize with flags {flags:?}");
                    return Err(ModelError::Unsupported(text));
                }
                (Operator::Resize, vec![first])
            }
            34 => {
                let (from, to) = (self.shapes[first], self.shapes[output]);
                if (from.h, from.w) != (to.h, to.w) || from.c > to.c {
                    return Err(ModelError::Unsupported("padding of rows or columns".into()));
                }
                (Operator::PadChannels, vec![first])
            }
            40 => (Operator::Mean, vec![first]),
            54 => (Operator::Prelu { slopes: self.numbers(second()?)? }, vec![first]),
            other => return Err(ModelError::Unsupported(format!("operator {other}"))),
        };
        Ok(Some(GraphNode { operator, inputs: reads, output }))
    }

    fn window(
        &self,
        size: (usize, usize),
        stride: (i32, i32),
        padding: u8,
        input: usize,
    ) -> Result<Window, ModelError> {
        let stride = (stride.0.max(1) as usize, stride.1.max(1) as usize);
        let shape = self.shapes[input];
        if size.0 == 0 || size.1 == 0 || size.0 > 31 || size.1 > 31 {
            return Err(ModelError::Unsupported(format!("a window of {size:?}")));
        }
        // SAME: the output has ceil(input / stride) elements, the odd zero comes last. VALID: none.
        let pad = |n: usize, size: usize, stride: usize| match padding {
            0 => ((n.div_ceil(stride).max(1) - 1) * stride + size).saturating_sub(n) / 2,
            _ => 0,
        };
        let pad = (pad(shape.h, size.0, stride.0), pad(shape.w, size.1, stride.1));
        Ok(Window { size, stride, pad })
    }
}

fn range_of(activation: u8) -> Result<OutputRange, ModelError> {
    match activation {
        0 => Ok(OutputRange::ALL),
        1 => Ok(OutputRange(0.0, f32::MAX)),
        3 => Ok(OutputRange(0.0, 6.0)),
        other => Err(ModelError::Unsupported(format!("activation {other}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_widened_exactly() {
        let cases = [
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x0001, 5.960_464_5e-8),
            (0x03ff, 6.097_555e-5),
            (0x7bff, 65504.0),
            (0x8000, -0.0),
        ];
        for (bits, value) in cases {
            assert_eq!(half_to_single(bits).to_bits(), f32::to_bits(value), "{bits:x}");
        }
    }

    #[test]
    fn damaged_files_are_errors() {
        assert!(parse(&[]).is_err());
        assert!(parse(&[255; 64]).is_err());
        let mut seed = 1_u32;
        for length in 0..400 {
            let bytes: Vec<u8> = (0..length)
                .map(|_| {
                    seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    (seed >> 28) as u8
                })
                .collect();
            let _ = parse(&bytes);
        }
    }
}
