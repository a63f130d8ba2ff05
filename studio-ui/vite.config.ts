import { defineConfig } from "vite";

// The page as it is served: three files that do not change when nothing changed.
export default defineConfig({
  base: "/assets/",
  esbuild: { jsx: "automatic", jsxImportSource: "preact" },
  build: {
    outDir: "../src/hybond/studio/page",
    emptyOutDir: true,
    assetsDir: ".",
    modulePreload: false,
    target: "es2022",
    rollupOptions: {
      output: {
        entryFileNames: "studio.js",
        chunkFileNames: "[name].js",
        assetFileNames: "studio[extname]",
      },
    },
  },
});
