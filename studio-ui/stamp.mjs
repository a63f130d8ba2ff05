// Note what the built page was made of; tests/studio/test_page.py compares it with what is here.
import { createHash } from "node:crypto";
import { readdirSync, readFileSync, writeFileSync } from "node:fs";

const files = [
  "index.html",
  "package-lock.json",
  "vite.config.ts",
  "vite.widget.config.ts",
  ...readdirSync("src").sort().map((f) => `src/${f}`),
];
const hash = createHash("sha256");
for (const file of files) hash.update(file + "\n").update(readFileSync(file, "utf8").replaceAll("\r\n", "\n"));
writeFileSync("../src/hybond/studio/page/sources.txt", hash.digest("hex") + "\n");
