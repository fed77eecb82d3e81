/** The uuids and scene names that the server gives to what this page lays out. */

export const STATUS = "poescope-status";
export const EPISODE = "poescope-episode";
export const MODEL = "poescope-model";
export const STEP = "poescope-step";
export const PLAY = "poescope-play";
export const SPEED = "poescope-speed";
export const PROGRESS = "poescope-progress";

export const EXPERTS = "poescope-experts";
export const SCOPE = "poescope-scope";
export const ALL_ON = "poescope-all-on";
export const SHARES = "poescope-shares";
export const switchOf = (expert: string) => `poescope-switch-${expert}`;
export const alphaOf = (expert: string) => `poescope-alpha-${expert}`;

export const FRAMES = ["truth", "input", "belief", "prediction", "error"] as const;
export type FrameName = (typeof FRAMES)[number];
export const frameOf = (name: FrameName) => `poescope-frame-${name}`;

export const CHARTS = ["shares", "latents", "position", "horizon", "psnr"] as const;
export type ChartName = (typeof CHARTS)[number];
export const chartOf = (name: ChartName) => `poescope-chart-${name}`;

export const ROLLOUT = [
  "poescope-context",
  "poescope-horizon",
  "poescope-predict-here",
  "poescope-sampled",
  "poescope-spread",
];
export const DAMAGE = ["vision", "haptic", "proprio"].flatMap((m) => [
  `poescope-damage-${m}`,
  `poescope-severity-${m}`,
]);
export const FIND = ["failure-previous", "failure-next", "event-previous", "event-next", "undo", "redo"].map(
  (name) => `poescope-${name}`,
);

export const KEY = "poescope-key";
export const LINE = "poescope-line";
export const STATE = "poescope-state";
export const KEYS = "poescope-keys";
export const META = "poescope-meta";
export const FACE = "poescope-face";

/** An arrow for each sensor, `/pull/vision`: what it pulls the position by. */
export const PULL = "/pull/";

/** Notifications of what the session said last; the page has a line for that. */
export const SAID = "poescope-note-";

/** One instance a step; a click on one goes there. */
export const PATH_POINTS = "/path/points";
