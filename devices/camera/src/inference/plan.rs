//! Fuses the operators of a model and assigns memory to its tensors.
//!
//! A convolution takes over the sum with a residual and the PReLU that follow it, so their tensors
//! are never written. Two tensors share memory if neither is needed while the other is.

use std::collections::BTreeMap;

use super::depthwise::PackedDepthwise;
use super::epilogue::Epilogue;
use super::flatbuffer::ModelError;
use super::matrix::PackedConvolution;
use super::tflite::{Graph, GraphNode, Operator, OutputRange, TensorShape, Window};

/// An operator that is ready to run.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Kernel {
    Convolution(PackedConvolution, Epilogue),
    Depthwise(PackedDepthwise, Epilogue),
    Prelu(Vec<f32>),
    Sum(OutputRange),
    PadChannels,
    MaxPool(Window),
    Resize,
    Copy,
    Concatenate,
    Mean,
    Logistic,
}

/// A tensor in memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Place {
    /// Index of its buffer.
    pub buffer: usize,
    pub shape: TensorShape,
}

/// One kernel with the tensors that it reads and writes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PlannedStep {
    pub kernel: Kernel,
    pub inputs: Vec<Place>,
    /// Added to a convolution's result.
    pub residual: Option<Place>,
    pub output: Place,
}

/// All kernels of a model, in order.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Plan {
    pub steps: Vec<PlannedStep>,
    /// Size of each buffer, in numbers.
    pub buffers: Vec<usize>,
    pub input: Place,
    pub outputs: Vec<Place>,
}

/// A step whose tensors have no memory yet.
struct Fused {
    kernel: Kernel,
    inputs: Vec<usize>,
    residual: Option<usize>,
    output: usize,
}

/// Plans a model for vectors of `lanes` numbers.
///
/// # Errors
/// Returns an error if shapes contradict each other.
pub(super) fn plan(graph: &Graph, lanes: usize) -> Result<Plan, ModelError> {
    let steps = fuse(graph, lanes)?;
    for step in &steps {
        check(graph, step)?;
    }
    place(graph, steps)
}

fn fuse(graph: &Graph, lanes: usize) -> Result<Vec<Fused>, ModelError> {
    // The only reader of each tensor that has one reader.
    let mut readers: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (i, node) in graph.nodes.iter().enumerate() {
        for input in &node.inputs {
            readers.entry(*input).or_default().push(i);
        }
    }
    let next = |tensor: usize| match readers.get(&tensor).map(Vec::as_slice) {
        Some([only]) if !graph.outputs.contains(&tensor) => Some((*only, &graph.nodes[*only])),
        _ => None,
    };
    // Steps in the place of the last operator that they take over.
    let mut steps: BTreeMap<usize, Fused> = BTreeMap::new();
    let mut taken = vec![false; graph.nodes.len()];
    for (i, node) in graph.nodes.iter().enumerate() {
        if taken[i] {
            continue;
        }
        let (mut last, mut output, mut residual, mut slopes) = (i, node.output, None, None);
        let free = matches!(&node.operator, Operator::Convolution { range, .. }
            | Operator::Depthwise { range, .. } if *range == OutputRange::ALL);
        if free {
            if let Some((at, after)) = next(output)
                && after.operator == (Operator::Sum { range: OutputRange::ALL })
                && let [a, b] = after.inputs.as_slice()
                && a != b
                && !taken[at]
            {
                residual = Some(if *a == output { *b } else { *a });
                (last, output, taken[at]) = (at, after.output, true);
            }
            if let Some((at, after)) = next(output)
                && let Operator::Prelu { slopes: own } = &after.operator
                && !taken[at]
            {
                slopes = Some(own);
                (last, output, taken[at]) = (at, after.output, true);
            }
        }
        let kernel = kernel(graph, node, slopes, lanes)?;
        steps.insert(last, Fused { kernel, inputs: node.inputs.clone(), residual, output });
    }
    Ok(steps.into_values().collect())
}

fn kernel(
    graph: &Graph,
    node: &GraphNode,
    slopes: Option<&Vec<f32>>,
    lanes: usize,
) -> Result<Kernel, ModelError> {
    let outputs = graph.shapes[node.output].c;
    let whole = |list: &[f32]| {
        let mut list = list.to_vec();
        list.resize(outputs.next_multiple_of(2 * lanes), 0.0);
        list
    };
    let epilogue = |bias: &[f32], range: OutputRange| {
        let right = bias.len() == outputs && slopes.is_none_or(|s| s.len() == outputs);
        let epilogue =
            Epilogue { bias: whole(bias), range, slopes: slopes.map(|s| whole(s.as_slice())) };
        right.then_some(epilogue).ok_or_else(|| {
            ModelError::Inconsistent(format!("a bias or slope for other than {outputs} channels"))
        })
    };
    Ok(match &node.operator {
        Operator::Convolution { window, weights, bias, range } => Kernel::Convolution(
            PackedConvolution::new(weights, outputs, *window, lanes),
            epilogue(bias, *range)?,
        ),
        Operator::Depthwise { window, weights, bias, range } => Kernel::Depthwise(
            PackedDepthwise::new(weights, outputs, *window, lanes),
            epilogue(bias, *range)?,
        ),
        Operator::Prelu { slopes } => Kernel::Prelu(slopes.clone()),
        Operator::Sum { range } => Kernel::Sum(*range),
        Operator::PadChannels => Kernel::PadChannels,
        Operator::MaxPool { window } => Kernel::MaxPool(*window),
        Operator::Resize => Kernel::Resize,
        Operator::Reshape => Kernel::Copy,
        Operator::Concatenate => Kernel::Concatenate,
        Operator::Mean => Kernel::Mean,
        Operator::Logistic => Kernel::Logistic,
    })
}

/// Checks everything that the kernels take for granted.
fn check(graph: &Graph, step: &Fused) -> Result<(), ModelError> {
    let to = graph.shapes[step.output];
    let from = graph.shapes[step.inputs[0]];
    let windowed = |window: &Window| {
        let side = |n: usize, size: usize, stride: usize, pad: usize| {
            (n + 2 * pad + stride).checked_sub(size).is_some_and(|room| room / stride > 0)
        };
        side(from.h, window.size.0, window.stride.0, window.pad.0)
            && side(from.w, window.size.1, window.stride.1, window.pad.1)
            && to.h <= from.h.div_ceil(window.stride.0)
            && to.w <= from.w.div_ceil(window.stride.1)
    };
    let good = to.count() > 0
        && from.count() > 0
        && step.residual.is_none_or(|r| graph.shapes[r] == to)
        && match &step.kernel {
            Kernel::Convolution(c, _) => {
                c.depth() == c.window.size.0 * c.window.size.1 * from.c && windowed(&c.window)
            }
            Kernel::Depthwise(d, _) => {
                d.taps(from.c) == d.window.size.0 * d.window.size.1
                    && from.c == to.c
                    && windowed(&d.window)
            }
            Kernel::Prelu(slopes) => slopes.len() == to.c && from == to,
            Kernel::Sum(_) => step.inputs.iter().all(|i| graph.shapes[*i] == to),
            Kernel::PadChannels => from.c <= to.c && (from.h, from.w) == (to.h, to.w),
            Kernel::MaxPool(window) => from.c == to.c && windowed(window),
            Kernel::Resize => from.c == to.c,
            Kernel::Copy | Kernel::Logistic => from.count() == to.count(),
            Kernel::Concatenate => {
                step.inputs.iter().map(|i| graph.shapes[*i].count()).sum::<usize>() == to.count()
                    && step.inputs.iter().all(|i| graph.shapes[*i].c == to.c)
            }
            Kernel::Mean => from.c == to.count(),
        };
    let text = || format!("shapes {from:?} and {to:?} do not fit their operator");
    good.then_some(()).ok_or_else(|| ModelError::Inconsistent(text()))
}

fn place(graph: &Graph, steps: Vec<Fused>) -> Result<Plan, ModelError> {
    let reads = |step: &Fused| step.inputs.iter().copied().chain(step.residual).collect::<Vec<_>>();
    let mut last: BTreeMap<usize, usize> = BTreeMap::new();
    for (i, step) in steps.iter().enumerate() {
        for tensor in reads(step) {
            last.insert(tensor, i);
        }
    }
    for output in &graph.outputs {
        last.insert(*output, usize::MAX);
    }
    let mut sizes: Vec<usize> = Vec::new();
    let mut free: Vec<usize> = Vec::new();
    let mut places: BTreeMap<usize, Place> = BTreeMap::new();
    let mut allot = |tensor: usize, free: &mut Vec<usize>| {
        let shape = graph.shapes[tensor];
        // The smallest that is large enough, else the largest, which grows.
        let fits = (0..free.len()).filter(|i| sizes[free[*i]] >= shape.count());
        let best = fits.min_by_key(|i| sizes[free[*i]]);
        let best = best.or_else(|| (0..free.len()).max_by_key(|i| sizes[free[*i]]));
        let buffer = best.map_or_else(
            || {
                sizes.push(0);
                sizes.len() - 1
            },
            |i| free.swap_remove(i),
        );
        sizes[buffer] = sizes[buffer].max(shape.count());
        Place { buffer, shape }
    };
    places.insert(graph.input, allot(graph.input, &mut free));
    let mut planned = Vec::new();
    for (i, step) in steps.into_iter().enumerate() {
        let known = |tensor: usize| {
            let missing = || ModelError::Inconsistent(format!("tensor {tensor} is never written"));
            places.get(&tensor).copied().ok_or_else(missing)
        };
        let inputs = step.inputs.iter().map(|t| known(*t)).collect::<Result<Vec<_>, _>>()?;
        let residual = step.residual.map(known).transpose()?;
        let output = allot(step.output, &mut free);
        places.insert(step.output, output);
        let mut done: Vec<usize> =
            step.inputs.iter().copied().chain(step.residual).collect::<Vec<_>>();
        done.sort_unstable();
        done.dedup();
        for tensor in done.into_iter().filter(|t| last.get(t) == Some(&i)) {
            free.extend(places.get(&tensor).map(|p| p.buffer));
        }
        planned.push(PlannedStep { kernel: step.kernel, inputs, residual, output });
    }
    let outputs = graph.outputs.iter().map(|t| places.get(t).copied());
    let outputs = outputs.collect::<Option<Vec<_>>>();
    let missing = || ModelError::Inconsistent("an output is never written".into());
    Ok(Plan {
        input: places[&graph.input],
        outputs: outputs.ok_or_else(missing)?,
        steps: planned,
        buffers: sizes,
    })
}
