/** What the server says of the session in one piece of JSON; `null` is what is unknown or not finite. */

export interface Meta {
  version: string;
  read_only: boolean;
  dataset: string;
  model: {
    index: number;
    count: number;
    name: string;
    source: string;
    update: number | null;
    latent: number;
    /** Whether there is a product to switch experts of. */
    product: boolean;
  };
  episode: {
    index: number;
    count: number;
    id: string;
    split: string | null;
    flags: string[];
    missing: string[];
  } | null;
  /** From 0. */
  step: number;
  steps: number;
  secs: number | null;
  playing: boolean;
  speed: number;
  looping: "off" | "all" | "selection";
  scope: "episode" | "onward" | "frame";
  context: number;
  horizon: number;
  /** The last step that the rollout has seen, from 0. */
  start: number;
  selection: [number, number] | null;
  events: { step: number; kind: "contact" | "mark" }[];
  force_newtons: number | null;
  force_over_time: (number | null)[];
  /** The prior last. */
  experts: ExpertMeta[];
  /** False: the dimension carries nothing. Empty where that is not known. */
  active: boolean[];
  badge: { kind: "trained" | "untrained" | "no-product"; text: string };
  error_of: "belief" | "prediction";
  position_error_cm: { belief: number | null; prediction: number | null } | null;
  psnr_db: { belief: number | null; prediction: number | null } | null;
  corruptions: { modality: string; damage: string; severity: number; from: number; until: number | null }[];
  control_edit: string | null;
  sampling: { shown: boolean; count: number; seed: number };
  scored: { done: number; of: number; asked: boolean };
  failure: { order: string; place: number | null; count: number };
  message: { error: boolean; text: string } | null;
  /** Which of all messages it is: the same words again are another one. */
  told: number;
  /** Something asked for is still being computed. */
  busy: boolean;
  /** False: the images are still of what was asked for before. */
  current: boolean;
}

export interface ExpertMeta {
  name: string;
  letter: string;
  /** The digit that switches it. */
  key: string;
  /** `#rrggbb`. */
  color: string;
  /** The block character whose density means the same without colour. */
  fill: string;
  alpha: number;
  /** Whether its input is damaged at the cursor. */
  damaged: boolean;
  switchable: boolean;
  /** Of each latent dimension, from 0 to 1. */
  share: (number | null)[];
  share_mean: number | null;
  share_position: number | null;
  information_nats: number | null;
  /** Against the prediction; nothing for the prior, and where the expert is off. */
  nis: NisMeta | null;
  pull_cm: [number, number] | null;
}

/** NIS of one sensor, over the active dimensions. */
export interface NisMeta {
  /** Against the head's own spread: not calibrated. */
  head: number;
  /** Against A P Aᵀ + Q; nothing where that is not known. */
  propagated: number | null;
  /** Degrees of freedom: the active dimensions. */
  dof: number;
  /** Where 95 % of well-specified sensors lie; nothing where α is neither 0 nor 1. */
  bounds: Bounds | null;
}

export interface Bounds {
  low: number;
  high: number;
}

/** One line of the table of keys. */
export interface KeyLine {
  group: string;
  keys: string[];
  label: string;
  help: string;
  /** What only a face can do: `help`, `zoom`, `view NAME`; nothing where it is the session's. */
  face: string | null;
}

/** The server's answer to a key or a line. */
export interface FaceAnswer {
  /** The counter of the key. */
  n: number;
  hint: string | null;
  /** The next key belongs to a mode or a line. */
  mode: boolean;
  palette: { line: string; entries: { name: string; keys: string; help: string }[]; chosen: number | null } | null;
  /** The expert that a mode is about. */
  expert: number;
  face: string | null;
  explain: { error: boolean; text: string } | null;
}

/** Before the first key: the server says no more than its number. */
export const NO_ANSWER: FaceAnswer = {
  n: 0,
  hint: null,
  mode: false,
  palette: null,
  expert: 0,
  face: null,
  explain: null,
};

/** Reads one of the JSON texts above; nothing where it is none, and the page shows less. */
export function parsed<T>(text: unknown): T | undefined {
  if (typeof text !== "string" || text === "") return undefined;
  try {
    const value: unknown = JSON.parse(text);
    return typeof value === "object" && value !== null ? (value as T) : undefined;
  } catch {
    return undefined;
  }
}
