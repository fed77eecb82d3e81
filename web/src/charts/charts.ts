/** The charts that the server keeps, in their places. */
import type { Client } from "../client";
import { type ChartName, STEP, chartOf } from "../names";
import { Chart, type ChartKind } from "./chart";

const KINDS: Record<ChartName, ChartKind> = {
  shares: { name: "shares", term: "share", title: "share of precision", x: "step", time: true, drawing: "stack" },
  latents: {
    name: "latents",
    term: "latents",
    title: "belief by latent dimension",
    x: "dim",
    time: false,
    drawing: "dimensions",
  },
  position: {
    name: "position",
    term: "position",
    title: "position error, cm",
    x: "step",
    time: true,
    drawing: "lines",
  },
  horizon: { name: "horizon", term: "horizon", title: "by steps ahead, cm", x: "ahead", time: false, drawing: "lines" },
  psnr: { name: "psnr", term: "psnr", title: "PSNR, dB", x: "step", time: true, drawing: "lines" },
};

export class Charts {
  readonly #client: Client;
  readonly #charts: Map<ChartName, Chart>;

  constructor(client: Client) {
    this.#client = client;
    const seek = (x: number) => client.choose(STEP, Math.round(x));
    this.#charts = new Map(Object.entries(KINDS).map(([name, kind]) => [name as ChartName, new Chart(kind, seek)]));
  }

  element(name: ChartName): HTMLElement {
    return (this.#charts.get(name) as Chart).element;
  }

  update(): void {
    const { meta } = this.#client;
    for (const [name, chart] of this.#charts) {
      const gui = this.#client.element(chartOf(name));
      const shown = gui !== undefined && gui.props["visible"] !== false && meta !== undefined;
      const ahead = meta !== undefined && meta.step > meta.start ? meta.step - meta.start : undefined;
      chart.update(
        shown
          ? {
              props: gui.props,
              now: KINDS[name].time ? meta.step + 1 : name === "horizon" ? ahead : undefined,
              boundary: KINDS[name].time ? meta.start + 1.5 : undefined,
              experts: meta.experts,
            }
          : undefined,
      );
    }
  }

  retint(): void {
    this.#charts.forEach((chart) => chart.retint());
  }
}
