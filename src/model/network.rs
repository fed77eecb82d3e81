//! A network's parameters: one flat tensor to train, and the names and shapes that a checkpoint has.
//!
//! Parameters are kept in the layout the kernels compute in. On disk they have PyTorch's names, shapes and order, so
//! that the authors' checkpoints and ours can be read by both: each tensor is a [`Slot`], a strided view of the flat one.

use candle_core::{DType, Device, Result, Tensor, Var, bail};
use rand::Rng;

use super::kernel::weight_norm::{Stretch, WeightNorm};

/// One tensor of a checkpoint as a strided view of a network's flat parameters.
#[derive(Clone, Debug)]
pub struct Slot {
    /// Its name within the network, as PyTorch has it.
    pub name: String,
    /// Its shape there.
    pub shape: Vec<usize>,
    /// The same numbers as axes `(length, stride in the flat parameters)`, outermost first.
    pub axes: Vec<(usize, isize)>,
    /// Offset of its first number.
    pub base: usize,
}

impl Slot {
    /// Calls `visit` with the offset in the flat parameters of each of its numbers, in its own row-major order.
    fn visit(&self, mut visit: impl FnMut(usize)) {
        fn go(axes: &[(usize, isize)], start: isize, visit: &mut impl FnMut(usize)) {
            match axes {
                [] => visit(start as usize),
                [(len, stride)] => {
                    (0..*len as isize).for_each(|i| visit((start + i * stride) as usize));
                }
                [(len, stride), rest @ ..] => {
                    for i in 0..*len as isize {
                        go(rest, start + i * stride, visit);
                    }
                }
            }
        }
        go(&self.axes, self.base as isize, &mut visit);
    }
}

/// How the numbers of a stretch are drawn before training.
#[derive(Clone, Copy, Debug)]
pub enum Init {
    /// Uniform in ± this; where normed, g becomes the norm.
    Uniform(f32),
    /// All zero.
    Zero,
    /// `[A_k | B_k]` with A the identity: rows of `latent` after `latent`, each of `columns`.
    Bases {
        /// Z.
        latent: usize,
        /// Z and the control's numbers.
        columns: usize,
        /// A and B are disturbed by up to this much either way; without it A is exact, and B uniform in [0, 1).
        disturbed: Option<f32>,
    },
}

/// Parameters of one network while it is described.
#[derive(Clone, Debug)]
pub struct Parameters {
    /// Which are normed.
    pub norm: WeightNorm,
    /// The checkpoint's view.
    pub slots: Vec<Slot>,
    inits: Vec<Init>,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            norm: WeightNorm {
                stretches: Vec::new(),
            },
            slots: Vec::new(),
            inits: Vec::new(),
        }
    }
}

impl Parameters {
    /// Adds a stretch; returns the offset of its first trained number.
    pub fn push(&mut self, stretch: Stretch, init: Init) -> usize {
        let offset = self.norm.trained();
        self.norm.stretches.push(stretch);
        self.inits.push(init);
        offset
    }

    /// Adds a view of what was pushed.
    pub fn slot(
        &mut self,
        name: impl Into<String>,
        shape: &[usize],
        axes: &[(usize, isize)],
        base: usize,
    ) {
        self.slots.push(Slot {
            name: name.into(),
            shape: shape.to_vec(),
            axes: axes.to_vec(),
            base,
        });
    }

    /// Numbers before training.
    pub fn init(&self, rng: &mut impl Rng) -> Vec<f32> {
        let mut theta = Vec::with_capacity(self.norm.trained());
        for (stretch, init) in self.norm.stretches.iter().zip(&self.inits) {
            let mut draw = |n: usize| -> Vec<f32> {
                (0..n)
                    .map(|i| match *init {
                        Init::Uniform(bound) => rng.random_range(-bound..=bound),
                        Init::Zero => 0.0,
                        Init::Bases {
                            latent,
                            columns,
                            disturbed,
                        } => {
                            let (row, column) = (i / columns % latent, i % columns);
                            let identity = f32::from(row == column);
                            match disturbed {
                                Some(bound) => identity + rng.random_range(-bound..=bound),
                                None if column < latent => identity,
                                None => rng.random_range(0.0..1.0),
                            }
                        }
                    })
                    .collect()
            };
            match *stretch {
                Stretch::Plain(len) => theta.extend(draw(len)),
                Stretch::Normed {
                    outer,
                    norms,
                    inner,
                } => {
                    let v = draw(outer * norms * inner);
                    let mut squares = vec![0.0_f32; norms];
                    for (i, v) in v.iter().enumerate() {
                        squares[i / inner % norms] += v * v;
                    }
                    theta.extend(squares.into_iter().map(f32::sqrt));
                    theta.extend(v);
                }
            }
        }
        theta
    }
}

/// What a network's parameters are at first: drawn before training, or blank before they are read.
pub type Draw<'a> = dyn FnMut(&Parameters) -> Vec<f32> + 'a;

/// A network's parameters as tensors.
#[derive(Debug)]
pub struct Network {
    /// Its name in a checkpoint: `img_enc`, `dyn`.
    pub name: String,
    parameters: Parameters,
    theta: Var,
}

impl Network {
    /// A network whose parameters `draw` gives.
    pub fn new(
        name: &str,
        parameters: Parameters,
        draw: &mut Draw,
        device: &Device,
    ) -> Result<Self> {
        let theta = Var::from_vec(draw(&parameters), parameters.norm.trained(), device)?;
        Ok(Self {
            name: name.to_owned(),
            parameters,
            theta,
        })
    }

    /// The flat trained parameters.
    pub fn theta(&self) -> &Var {
        &self.theta
    }

    /// Which of them are normed.
    pub fn norm(&self) -> &WeightNorm {
        &self.parameters.norm
    }

    /// The weights that layers compute with, differentiable with respect to [`Self::theta`].
    pub fn folded(&self) -> Result<Tensor> {
        self.theta
            .as_tensor()
            .apply_op1(self.parameters.norm.clone())
    }

    /// Views in the checkpoint's names and order.
    pub fn slots(&self) -> &[Slot] {
        &self.parameters.slots
    }

    /// Replaces every parameter by what `find` has for each slot, in the slot's own order.
    pub fn fill(&self, mut find: impl FnMut(&Slot) -> Result<Vec<f32>>) -> Result<()> {
        let mut theta = vec![0.0; self.theta.elem_count()];
        for slot in self.slots() {
            let numbers = find(slot)?;
            let wanted: usize = slot.shape.iter().product();
            if numbers.len() != wanted {
                bail!(
                    "{}.{}: {} numbers where {wanted} are wanted",
                    self.name,
                    slot.name,
                    numbers.len()
                );
            }
            let mut numbers = numbers.into_iter();
            slot.visit(|at| theta[at] = numbers.next().unwrap_or_default());
        }
        self.theta.set(&Tensor::from_vec(
            theta,
            self.theta.shape(),
            self.theta.device(),
        )?)
    }

    /// The numbers of `slot` in `flat`, which is laid out as theta (itself or its gradient).
    pub fn view(slot: &Slot, flat: &[f32]) -> Vec<f32> {
        let mut numbers = Vec::with_capacity(slot.shape.iter().product());
        slot.visit(|at| numbers.push(flat[at]));
        numbers
    }

    /// Every slot as a tensor, in order.
    pub fn tensors(&self) -> Result<Vec<(String, Tensor)>> {
        let theta = self.theta.to_dtype(DType::F32)?.to_vec1::<f32>()?;
        self.slots()
            .iter()
            .map(|slot| {
                let tensor = Tensor::from_vec(
                    Self::view(slot, &theta),
                    slot.shape.as_slice(),
                    &Device::Cpu,
                )?;
                Ok((format!("{}.{}", self.name, slot.name), tensor))
            })
            .collect()
    }
}
