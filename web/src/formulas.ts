/** What the numbers on the page mean: formula, reading, trap. One table for tooltips and help. */

export interface Term {
  title: string;
  /** Subscripts as `_{…}`, superscripts as `^{…}`. */
  formula?: string;
  text: string;
}

export const TERMS = {
  alpha: {
    title: "α, switch and tempering",
    formula: "T* = Σ_{i} α_{i} T_{i}",
    text: "0 takes the expert out of the product, 1 leaves it as trained. In between it counts for less, above 1 for more.",
  },
  scope: {
    title: "How far a switch reaches",
    text: "The whole episode, from this step on, or this step alone. Later beliefs start from the changed one.",
  },
  share: {
    title: "Precision share",
    formula: "s_{i,d} = α_{i} T_{i,d} ⁄ T*_{d}",
    text: "The part of the belief's sharpness in latent dimension d that expert i supplies; a column adds up to 1. Grey dimensions carry nothing over the data.",
  },
  shareMean: {
    title: "Mean share",
    formula: "S_{i} = mean_{d} s_{i,d}",
    text: "Over all dimensions alike, also those that carry nothing.",
  },
  sharePosition: {
    title: "Share of the position",
    formula: "Σ_{d} W_{kd}² Σ*_{d} s_{i,d} ⁄ Σ_{d} W_{kd}² Σ*_{d}",
    text: "Weighted by what moves the position estimate, mean of both axes.",
  },
  information: {
    title: "Information",
    formula: "ΔH_{i} = ½ Σ_{d} ln(T*_{d} ⁄ T*_{−i,d})",
    text: "Entropy in nats that the expert removes when it comes last. The order matters: these do not add up.",
  },
  nisHead: {
    title: "NIS against the head",
    formula: "ν_{i}ᵀ (Σ_{i}⁄α_{i} + Σ_{0})^{−1} ν_{i},  ν_{i} = μ_{i} − μ_{0}",
    text: "The sensor against the prediction with the head's own spread. Not calibrated: the head states the noise of one step and does not carry the last belief's spread along, so this reads too high even where the model is right. ▲ and ▼ go by the bounds of the one beside it.",
  },
  nisPropagated: {
    title: "NIS against A P Aᵀ + Q",
    formula: "ν_{i}ᵀ (Σ_{i}⁄α_{i} + A P Aᵀ + Q)^{−1} ν_{i}",
    text: "The same against a prediction that carries the last belief's spread along. χ² with as many degrees of freedom as there are active dimensions, so about that number if sensor and prediction are as sure as they should be. 95 % lie within the bounds: ▲ above them one of the two claims too much, ▼ below them too little. No bounds where α is neither 0 nor 1.",
  },
  pull: {
    title: "Pull",
    formula: "v_{i} = W (s_{i} ⊙ (μ_{i} − μ_{0}))",
    text: "What the sensor moves the position by, in centimetres. The pulls add up to the whole correction of the prediction; they may oppose one another.",
  },
  surprise: {
    title: "Surprise",
    formula: "KL(belief ‖ prior)",
    text: "How much the sensors changed what was predicted, in nats.",
  },
  badge: {
    title: "Trained or not",
    text: "Whether training has shown the model this set of experts. Without the prior, and with α other than 0 or 1, nothing is promised.",
  },
  truth: { title: "Truth", text: "The frame as recorded." },
  input: { title: "Input", text: "What the model sees instead: vision is damaged at this step." },
  belief: {
    title: "Belief, decoded",
    formula: "q(z_{t}) ∝ p(z_{t} | z_{t−1}, u_{t−1}) Π_{i} q̃_{i}(z_{t})",
    text: "The product of the experts that are on, decoded to a frame.",
  },
  prediction: {
    title: "Prediction, decoded",
    formula: "z_{t+1} = A_{t} z_{t} + B_{t} u_{t}",
    text: "The dynamics alone from the last step of the context on, with known controls. Switches do not act on it.",
  },
  error: {
    title: "Signed error",
    text: "Prediction less truth, where there is a prediction, else belief less truth. Orange is too bright, blue too dark, in parts of the grey range.",
  },
  psnr: {
    title: "PSNR",
    formula: "10 log_{10}(1 ⁄ mean squared error)",
    text: "Of a decoded frame against the truth, in dB; more is better.",
  },
  latents: {
    title: "Latent dimensions",
    text: "Mean and ±1σ of the belief at this step, and where each expert alone would put it.",
  },
  position: {
    title: "Position error",
    formula: "‖p − (W μ* + b)‖,  P = W Σ* Wᵀ + R",
    text: "Distance of the plate's estimate from where it was. The band is the σ that the belief claims.",
  },
  horizon: {
    title: "By horizon",
    formula: "P ← A P Aᵀ + Q",
    text: "Error of the prediction against steps ahead, with the spread it claims, beside the error of a plate that stands still.",
  },
  ellipse: {
    title: "The table",
    text: "The plate as recorded, and pale where it is predicted. Around the belief: the solid ellipse holds one σ, 39 % of the mass in a plane, the dashed one 95 %. Arrows with letters are the sensors' pulls, one after the other; the red one is the force of the tip on the plate as measured, 1 cm a newton. A click on the path goes there.",
  },
  damage: {
    title: "Damaged input",
    text: "The sensor stays in the product, but what it sees is damaged. A good expert then lowers its own share. Not the same as switching it off.",
  },
  context: {
    title: "Context and horizon",
    text: "So many images are seen, then so many are predicted.",
  },
  sample: {
    title: "Mean path or sample",
    text: "The mean path is deterministic. A sample draws the latent at each step; its noise has a seed.",
  },
} satisfies Record<string, Term>;

export type TermName = keyof typeof TERMS;

/** The pieces of a formula, in order. */
export function pieces(formula: string): { text: string; place: "base" | "sub" | "sup" }[] {
  return formula
    .split(/([_^]\{[^}]*\})/)
    .filter((part) => part !== "")
    .map((part) => {
      const shifted = /^([_^])\{([^}]*)\}$/.exec(part);
      if (shifted === null) return { text: part, place: "base" as const };
      return { text: shifted[2] ?? "", place: shifted[1] === "_" ? ("sub" as const) : ("sup" as const) };
    });
}
