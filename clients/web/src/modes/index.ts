// All modes, in the order of their keys.

import type { Bench } from "../bench.ts";
import { CurvesMode } from "./curves.ts";
import { CutMode } from "./cut.ts";
import { FieldMode } from "./field.ts";
import type { Mode } from "./mode.ts";
import { NurbsMode } from "./nurbs.ts";
import { PairMode } from "./pair.ts";
import { SetMode } from "./set.ts";
import { SplineMode } from "./spline.ts";
import { SubdivisionMode } from "./subdivision.ts";
import { TraceMode } from "./trace.ts";

export const allModes = (bench: Bench): Mode[] => [
  new PairMode(bench),
  new FieldMode(bench),
  new SetMode(bench),
  new CurvesMode(bench),
  new TraceMode(bench),
  new SplineMode(bench),
  new CutMode(bench),
  new SubdivisionMode(bench),
  new NurbsMode(bench),
];
