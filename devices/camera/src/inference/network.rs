//! A model that is ready to run.

use pulp::{Arch, Scalar128b, Simd, WithSimd};

use super::elementwise;
use super::flatbuffer::ModelError;
use super::plan::{self, Kernel, Plan, PlannedStep};
use super::tflite::{self, TensorShape};

/// A model with its memory. Running it allocates nothing after the first time.
#[derive(Debug)]
pub struct Network {
    plan: Plan,
    buffers: Vec<Vec<f32>>,
    scratch: Vec<f32>,
    arch: Arch,
}

/// Runs `work` with the processor's vectors.
fn dispatch<W: WithSimd>(arch: Arch, work: W) -> W::Output {
    match arch {
        // Without AVX2: four lanes of the baseline.
        Arch::Scalar => Scalar128b.vectorize(work),
        arch => arch.dispatch(work),
    }
}

struct LaneCount;

impl WithSimd for LaneCount {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        S::F32_LANES
    }
}

impl Network {
    /// Loads a `.tflite` file.
    ///
    /// # Errors
    /// Returns an error if the file is damaged or uses an operator that is not known.
    pub fn load(bytes: &[u8]) -> Result<Self, ModelError> {
        let arch = Arch::new();
        let plan = plan::plan(&tflite::parse(bytes)?, dispatch(arch, LaneCount))?;
        let buffers = plan.buffers.iter().map(|n| vec![0.0; *n]).collect();
        Ok(Network { plan, buffers, scratch: Vec::new(), arch })
    }

    /// Returns the shape of the input.
    pub fn input_shape(&self) -> TensorShape {
        self.plan.input.shape
    }

    /// Returns the input, to be filled before [`Network::run`].
    pub fn input_mut(&mut self) -> &mut [f32] {
        let place = self.plan.input;
        &mut self.buffers[place.buffer][..place.shape.count()]
    }

    /// Computes the outputs. The input is overwritten.
    pub fn run(&mut self) {
        let arch = self.arch;
        dispatch(arch, Pass { network: self });
    }

    /// Returns output `i` of the last run; empty if there is no such output.
    pub fn output(&self, i: usize) -> &[f32] {
        let place = self.plan.outputs.get(i);
        place.map_or(&[], |p| &self.buffers[p.buffer][..p.shape.count()])
    }

    /// Returns the number of outputs.
    pub fn output_count(&self) -> usize {
        self.plan.outputs.len()
    }
}

struct Pass<'a> {
    network: &'a mut Network,
}

impl WithSimd for Pass<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Network { plan, buffers, scratch, .. } = self.network;
        for step in &plan.steps {
            // Taken out while it is written; no input has the same buffer.
            let mut output = std::mem::take(&mut buffers[step.output.buffer]);
            run_step(simd, step, buffers, &mut output[..step.output.shape.count()], scratch);
            buffers[step.output.buffer] = output;
        }
    }
}

#[inline(always)]
fn run_step<S: Simd>(
    simd: S,
    step: &PlannedStep,
    buffers: &[Vec<f32>],
    output: &mut [f32],
    scratch: &mut Vec<f32>,
) {
    let numbers = |place: &plan::Place| &buffers[place.buffer][..place.shape.count()];
    let to = step.output.shape;
    let residual = step.residual.as_ref().map(numbers);
    let [first, ..] = step.inputs.as_slice() else { return };
    let (input, from) = (numbers(first), first.shape);
    match &step.kernel {
        Kernel::Convolution(c, epilogue) => {
            c.run(simd, epilogue, (input, from), (output, to), residual, scratch);
        }
        Kernel::Depthwise(d, epilogue) => {
            d.run(simd, epilogue, (input, from), (output, to), residual, scratch);
        }
        Kernel::Prelu(slopes) => elementwise::prelu(input, slopes, output),
        Kernel::Sum(range) => {
            let second = step.inputs.get(1).map_or(input, numbers);
            elementwise::sum(input, second, *range, output);
        }
        Kernel::PadChannels => elementwise::pad_channels(input, from.c, output, to.c),
        Kernel::MaxPool(window) => elementwise::max_pool(window, (input, from), (output, to)),
        Kernel::Resize => elementwise::resize((input, from), (output, to)),
        Kernel::Copy => output.copy_from_slice(input),
        Kernel::Concatenate => {
            let mut at = 0;
            for place in &step.inputs {
                let piece = numbers(place);
                output[at..at + piece.len()].copy_from_slice(piece);
                at += piece.len();
            }
        }
        Kernel::Mean => elementwise::mean(input, output),
        Kernel::Logistic => elementwise::logistic(input, output),
    }
}
