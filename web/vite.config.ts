// One page, one script, one style sheet: files of their own, so that the server's content security policy can forbid
// everything inline. `POESCOPE_WEB_OUT` is where build.rs wants the bundle.
import { defineConfig } from "vite";

export default defineConfig({
  base: "./",
  build: {
    outDir: process.env["POESCOPE_WEB_OUT"] ?? "dist",
    emptyOutDir: true,
    target: "es2022",
    // Nothing small is turned into a data: address, which the policy would refuse.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 2000,
    reportCompressedSize: false,
    rolldownOptions: {
      output: {
        entryFileNames: "assets/[name]-[hash].js",
        assetFileNames: "assets/[name]-[hash][extname]",
      },
    },
  },
  server: { host: "127.0.0.1" },
  test: { include: ["tests/unit/**/*.test.ts"], environment: "node" },
} as Parameters<typeof defineConfig>[0]);
