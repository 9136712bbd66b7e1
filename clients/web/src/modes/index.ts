// All modes, in the order of their keys.

import type { Bench } from "../bench.ts";
import type { Mode } from "./mode.ts";
import { PairMode } from "./pair.ts";

export const allModes = (bench: Bench): Mode[] => [new PairMode(bench)];
