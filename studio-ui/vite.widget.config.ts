import { defineConfig } from "vite";

// The same page as one module for notebooks.
export default defineConfig({
  esbuild: { jsx: "automatic", jsxImportSource: "preact" },
  build: {
    outDir: "../src/hybond/studio/page",
    emptyOutDir: false,
    target: "es2022",
    cssCodeSplit: false,
    lib: { entry: "src/widget.tsx", formats: ["es"], fileName: () => "widget.js" },
    rollupOptions: { output: { assetFileNames: "widget[extname]" } },
  },
});
