// Made from the contract by generate.py; changes belong there.

export type BatchRequest = ({
  query: "all-pairs";
  mesh: Name;
  vertices: Index[];
} | {
  query: "fields";
  meshes: Name[];
  set: Set;
  max_distance?: number;
});

export type Batch = {
  id: JobId;
  state: BatchState;
  items: Count;
  /** Items that have an answer. */
  done: number;
  /** Of these, those whose answer is a problem. */
  failed: number;
  progress: number;
  created: string;
};

/** `done`: every item has an answer. `cancelled`: no more answers come. */
export type BatchState = ("running" | "done" | "cancelled");

export type BatchList = {
  batches: Batch[];
  next: (string | null);
};

export type BatchResults = {
  results: Array<{
    item: Index;
    status: number;
    mesh: Name;
    vertex?: Index;
    /** What the item was answered: that of `matrix`, or of `POST …/fields`. */
    answer?: Record<string, unknown>;
    problem?: Problem;
  }>;
  state: BatchState;
  /** The `cursor` or `after` of the next page. */
  next: (string | null);
};

export type JobId = string;

export type Name = string;

export type Index = number;

export type IndexPair = [Index, Index];

export type Count = number;

export type Vector = [number, number, number];

/** Its two vertices. */
export type Edge = [Index, Index];

/** Exactly one of five forms, or a text as in URLs. */
export type Point = (CompactPoint | VertexPoint | EdgePoint | FacePoint | SpacePoint | RayPoint);

export type VertexPoint = {
  vertex: Index;
};

export type EdgePoint = {
  edge: Edge;
  /** From the first listed vertex. */
  t: number;
};

export type FacePoint = {
  face: Index;
  barycentric: Vector;
};

/** The nearest point of the surface. */
export type SpacePoint = {
  xyz: Vector;
  /** How far the point may be moved; by default any distance. */
  max_snap?: number;
};

/** The ray's first hit. */
export type RayPoint = {
  ray: {
    origin: Vector;
    direction: Vector;
  };
};

/** `v:12` a vertex; `e:3-9:0.25` an edge and t from the first listed vertex; `f:34:0.2,0.3,0.5` a face and barycentric coordinates; `p:1.0,2.0,3.0` the nearest point of the surface. */
export type CompactPoint = string;

/** Compact points with semicolons between them. */
export type CompactPoints = string;

/** All that is known of a point: `vertex`, or `edge` and `t`, when it lies on one (`face` is the lowest-numbered face there then), `snap_distance` when it was snapped. */
export type PointAnswer = {
  face: Index;
  barycentric: Vector;
  xyz: Vector;
  vertex?: Index;
  edge?: Edge;
  t?: number;
  snap_distance?: number;
};

export type NearestRequest = {
  point: Point;
};

export type PairRequest = {
  from: Point;
  to: Point;
  /** Points to go by way of, in this order. */
  via?: Point[];
};

/** `null` when there is none; `reason` says why. */
export type Distance = (number | null);

/** `no_path`: the two points, or two that follow each other, lie on different components. */
export type Reason = "no_path";

export type DistanceAnswer = {
  distance: Distance;
  reason?: Reason;
  from: PointAnswer;
  to: PointAnswer;
  /** When the request has such points. */
  via?: PointAnswer[];
};

export type PathAnswer = {
  distance: Distance;
  reason?: Reason;
  from: PointAnswer;
  to: PointAnswer;
  /** When the request has such points. */
  via?: PointAnswer[];
  /** `null` when there is none. */
  path: (Path | null);
};

export type MatrixRequest = {
  sources: MatrixPoints;
  targets: MatrixPoints;
  /** Distances beyond it are not looked for, which saves time. */
  max_distance?: number;
};

/** There may be 4,000,000 pairs of a source and a target. */
export type MatrixPoints = Point[];

export type MatrixAnswer = {
  /** A row per source, in the order of the request, with a distance per target. */
  distances: Array<Distance[]>;
  /** Only when a distance is `null`: rows of the same shape, with the reason where the distance is `null`, and `null` elsewhere. `no_path`: the two points lie on different components. `beyond_max_distance`: they are farther apart. */
  reasons?: ("no_path" | "beyond_max_distance" | null)[][];
};

/** The body of a query of its own with the name of the query, and perhaps what would stand in the query string of that one. */
export type BatchLine = (BatchPair | BatchNearest | BatchMatrix | BatchSetDistance | BatchCurveDistance);

/** The fields of the answer that are wanted, as `a,b` or as an array. */
export type BatchNames = (string | string[]);

export type BatchPair = {
  query: ("distance" | "path");
  fields?: BatchNames;
  geometry?: ("full" | "xyz" | "none");
  from: Point;
  to: Point;
  via?: Point[];
};

export type BatchNearest = {
  query: "nearest";
  fields?: BatchNames;
  geometry?: ("full" | "xyz" | "none");
  point: Point;
};

export type BatchMatrix = {
  query: "matrix";
  fields?: BatchNames;
  geometry?: ("full" | "xyz" | "none");
  sources: MatrixPoints;
  targets: MatrixPoints;
  max_distance?: number;
};

export type BatchCurveDistance = {
  query: "curve-distance";
  fields?: BatchNames;
  geometry?: ("full" | "xyz" | "none");
  a: Curve;
  b: Curve;
  measure?: ("min" | "hausdorff");
};

export type BatchSetDistance = {
  query: "distance-to-set";
  fields?: BatchNames;
  geometry?: ("full" | "xyz" | "none");
  set: Set;
  points: EvaluationPoints;
  path?: boolean;
};

/** The answer of the query beside `status`, which is 200; or a problem, which names the line in `elements` and has a `pointer` into it. */
export type BatchAnswer = (BatchPairAnswer | BatchNearestAnswer | BatchMatrixAnswer | BatchSetDistanceAnswer | BatchCurveDistanceAnswer | Problem);

export type BatchPairAnswer = {
  status: 200;
  distance?: Distance;
  reason?: Reason;
  from?: PointAnswer;
  to?: PointAnswer;
  via?: PointAnswer[];
  path?: (Path | null);
};

export type BatchNearestAnswer = {
  status: 200;
  face?: Index;
  barycentric?: Vector;
  xyz?: Vector;
  vertex?: Index;
  edge?: Edge;
  t?: number;
  snap_distance?: number;
};

export type BatchMatrixAnswer = {
  status: 200;
  distances?: Array<Distance[]>;
  reasons?: (string | null)[][];
};

export type BatchCurveDistanceAnswer = {
  status: 200;
  distance?: Distance;
  reason?: Reason;
  closest?: CurvePlaces;
  a_to_b?: Distance;
  b_to_a?: Distance;
  farthest?: {
    a_to_b: CurvePlaces;
    b_to_a: CurvePlaces;
  };
  path?: (Path | null);
};

export type BatchSetDistanceAnswer = {
  status: 200;
  results?: Result[];
};

/** A polyline on the surface, consecutive points within one face, from the first point to the last. */
export type Path = {
  length: number;
  points?: (PathPoint | Vector)[];
};

/** A point with the element that it lies on: `vertex`, or `edge` and `t`, or `face` and `barycentric`. */
export type PathPoint = {
  face?: Index;
  barycentric?: Vector;
  xyz: Vector;
  vertex?: Index;
  edge?: Edge;
  t?: number;
};

export type FieldId = string;

/** A curve on the surface: points joined in turn by shortest paths, vertices that share edges in turn, a boundary by its place in the mesh's description, or a spline, as the path that `spline` answers. Of joined points those within 4e-12 of an edge or a vertex, as barycentric coordinates go, are put there. */
export type Curve = ({
  points: Point[];
  /** The last is joined to the first. */
  closed?: boolean;
} | {
  vertices: Index[];
  /** The last is joined to the first. */
  closed?: boolean;
} | {
  boundary: Index;
} | {
  spline: SplineCurve;
});

/** What distances are measured to. Members are numbered points first, then curves, then boundaries; one of them at least. Distances to curves are exact: to the curve itself, not to samples of it. */
export type Set = {
  points?: (CompactPoint | Member)[];
  curves?: CurveMember[];
  /** All of the mesh's boundary loops, or some by their places in its description. */
  boundaries?: ("all" | (Index | {
    boundary: Index;
    offset?: number;
    /** At most 128 bytes of UTF-8. */
    label?: string;
  })[]);
};

/** A curve, with an offset that is added to distances from it and a label to know it by. */
export type CurveMember = {
  points?: Point[];
  vertices?: Index[];
  boundary?: Index;
  spline?: SplineCurve;
  /** The last is joined to the first. */
  closed?: boolean;
  offset?: number;
  /** At most 128 bytes of UTF-8. */
  label?: string;
};

/** A point in one of its five forms, with an offset that is added to distances from it and a label to know it by. */
export type Member = {
  vertex?: Index;
  edge?: Edge;
  t?: number;
  face?: Index;
  barycentric?: Vector;
  xyz?: Vector;
  max_snap?: number;
  ray?: Record<string, unknown>;
  offset?: number;
  /** At most 128 bytes of UTF-8. */
  label?: string;
};

export type CurveDistanceRequest = {
  a: Curve;
  b: Curve;
  measure?: ("min" | "hausdorff");
};

export type CurvePlace = {
  point: PointAnswer;
  parameter: number;
  /** In radians. */
  angle: (number | null);
};

export type CurvePlaces = ({
  a: CurvePlace;
  b: CurvePlace;
} | null);

/** `closest` with `min`; `a_to_b`, `b_to_a` and `farthest` with `hausdorff`. */
export type CurveDistanceAnswer = {
  distance: Distance;
  reason?: Reason;
  closest?: CurvePlaces;
  a_to_b?: Distance;
  b_to_a?: Distance;
  farthest?: {
    a_to_b: CurvePlaces;
    b_to_a: CurvePlaces;
  };
  path: (Path | null);
};

export type SetDistanceRequest = {
  set: Set;
  points: EvaluationPoints;
  path?: boolean;
};

export type EvaluationRequest = {
  points: EvaluationPoints;
  path?: boolean;
  gradient?: boolean;
};

export type EvaluationPoints = Point[];

export type ResultsAnswer = {
  results: Result[];
};

export type Result = {
  distance: Distance;
  /** `no_path`: no member lies on the point's component. `beyond_max_distance`: the field ends before it. */
  reason?: ("no_path" | "beyond_max_distance");
  /** The nearest member; `null` when there is no distance. Of several that are as near it is one. */
  nearest: ({
    index: Index;
    label: (string | null);
    point: PointAnswer;
  } | null);
  /** From the point to the nearest member, if it was asked for; `null` when there is none. */
  path?: (Path | null);
  /** The direction in which the distance grows, if it was asked for: the one in which the shortest path goes on straight that comes to the point. (At a vertex: with half of the angle around it to either side; at the boundary it may lead off the surface, and the vector is then in the plane of the face through which the path comes.) `null` when there is no distance, and at a member, where it grows in all directions. */
  gradient?: (Direction | null);
};

export type FieldRequest = {
  set: Set;
  /** Distances beyond it are not computed, which saves time and memory. */
  max_distance?: number;
};

export type Field = {
  id: FieldId;
  /** Those that are kept of it; with `max_distance` perhaps those of a field of the same set that reaches farther. */
  wedges: number;
  /** What these take in memory. */
  bytes: number;
  /** What they took to compute, in all. */
  build_ms: number;
  /** The largest distance; `null` when it is beyond `max_distance`, or so close below that it can not be told. */
  max: (number | null);
  reason?: "beyond_max_distance";
  /** Where it is; it may lie inside a face. */
  farthest: (PointAnswer | null);
  /** Members of the set. */
  members: number;
  max_distance: (number | null);
  /** The `Set` of the request that created the field; `null` when its text is longer than 4,096 bytes. */
  set: (Record<string, unknown> | null);
  created: string;
  /** Requests that have named the field since it was created; in lists only. */
  uses?: number;
};

export type BoundaryList = {
  boundaries: BoundaryLoop[];
  /** `after` of the next page; `null`: this is the last. */
  next: (string | null);
};

export type FieldList = {
  fields: Field[];
  /** `after` of the next page; `null`: this is the last. */
  next: (string | null);
};

export type Values = {
  /** `null` for vertices that no face has, that no path leads to, and beyond `max_distance`. */
  values: Distance[];
};

/** A direction at a point of the surface, in both forms. Angles grow counter-clockwise as seen from outside. Zero is: in a face the direction of its first edge (from its first corner to its second, in the file's order); on an edge from its lower to its higher vertex, the surface being flat across it; at an interior vertex the edge to its lowest-numbered neighbour, the total angle counting as 2 pi; at a boundary vertex the boundary edge from which the faces follow counter-clockwise, unscaled. `xyz` is the unit vector in the plane of the face into which the direction leads. */
export type Direction = {
  angle: number;
  xyz: Vector;
};

/** One of `levels` and `count`. */
export type IsolinesRequest = {
  levels?: number[];
  /** As many levels, evenly between 0 and the field's maximum, both left out. */
  count?: number;
  /** How far from the line its polyline may be, a length; the default is as for GET. */
  tolerance?: number;
  arcs?: boolean;
};

export type IsolinesAnswer = {
  isolines: Isoline[];
};

export type VoronoiRequest = {
  set: Set;
  /** How far from a bisector its polyline may be, a length. By default 1/2000 of the diagonal of the mesh's bounding box. */
  tolerance?: number;
};

export type VoronoiAnswer = {
  /** By vertex index the nearest member, by its number; null at a vertex that no path reaches or no face refers to. */
  labels: (number | null)[];
  /** In order of their members. */
  bisectors: Bisector[];
};

export type Bisector = {
  /** The numbers of both, ascending. */
  members: [number, number];
  closed: boolean;
  /** Of the polyline. */
  length: number;
  /** A polyline as in a path; both members are as near to each of its points. A closed one ends in its first point. */
  points?: (PathPoint | Vector)[];
};

export type CutRequest = {
  curve: Curve;
  /** The only piece that is wanted is the one that holds this point. */
  inside?: Point;
  /** The faces of the pieces only, no new meshes. */
  select_only?: boolean;
  /** The new meshes', one a piece. */
  names?: Name[];
};

export type CutAnswer = {
  /** There are more components than before. */
  separates: boolean;
  pieces: CutPiece[];
  /** How far the curve was moved at most. */
  largest_shift: number;
};

export type CutPiece = {
  name?: Name;
  vertices?: number;
  faces: number;
  area: number;
  /** For each vertex of the piece the parent's, null for a new one; the parent's come first, in order. Not with `select_only`. */
  vertex_map?: (Index | null)[];
  /** For each face of the piece the parent's that it lies in, in ascending order. */
  face_map: Index[];
};

/** A direction at a point: an angle, a vector of any length, or an object with either, as answers have it (of both the angle counts). A vector is projected: in a face at right angles to it, at a vertex along its normal. What leads over the boundary is refused. */
export type DirectionRequest = (number | Vector | {
  angle?: number;
  xyz?: Vector;
});

/** One of `directions` and `fan`. */
export type TraceRequest = {
  start: Point;
  directions?: DirectionRequest[];
  /** So many directions at equal angles all around, from zero; at the boundary from one side of it to the other. */
  fan?: number;
  length: number;
  vertex_rule?: ("bisect" | "limit_normal");
  boundary_rule?: ("stop" | "slide");
  /** End where the line crosses or touches itself. */
  stop_at_self_intersection?: boolean;
  step_limit?: number;
};

/** A path with how it ended. `end_direction` is where it would go on; where it met the boundary this leads off the surface. */
export type TracedPath = {
  length: number;
  points?: (PathPoint | Vector)[];
  end_direction: Direction;
  end_reason: ("length" | "boundary" | "self_intersection" | "step_limit");
};

export type TraceAnswer = {
  start: PointAnswer;
  paths: TracedPath[];
};

/** `direction` and `length`, or `segments`, or any vector that `log` answers, as it is. `exp` traces the segments of a vector that has both; `transport` and `combine` use its direction and length. The direction of a vector of length 0 may be `null`. The length `null` says that no path leads there. `reason` and `cut_locus` change nothing. */
export type VectorRequest = {
  direction?: (DirectionRequest | null);
  length?: (number | null);
  reason?: string;
  cut_locus?: boolean;
  /** One after the other; after the first a direction is an angle. */
  segments?: Array<{
    direction: DirectionRequest;
    length: number;
  }>;
};

/** `direction` is `null` where there is none: the length is 0, or there is no path. */
export type TangentVector = {
  direction: (Direction | null);
  length: (number | null);
  reason?: "no_path";
  /** Other paths are as short and leave in other directions. */
  cut_locus?: true;
  segments?: Array<{
    direction: Direction;
    length: number;
  }>;
};

export type ExpRequest = {
  start: Point;
  /** At most 10000, and as many segments in all. `null`, as `log` answers it for a vertex without faces, is a vector to which no path leads. */
  vectors: (VectorRequest | null)[];
  /** A factor for each vector. None of them may be `null`, without a path, or of segments alone. */
  combine?: number[];
};

export type ExpAnswer = {
  start: PointAnswer;
  vectors: TangentVector[];
  /** `null` for a vector to which no path leads. */
  points: (PointAnswer | null)[];
  /** `null` for a vector to which no path leads. */
  paths: (TracedPath | null)[];
};

export type LogRequest = {
  from: Point;
  to: (Point[] | "all");
  first_vector_only?: boolean;
};

export type LogAnswer = {
  from: PointAnswer;
  vectors: (TangentVector | null)[];
};

export type TransportRequest = {
  from: Point;
  to: Point;
  /** Each with a direction and a length, or one segment. A vector to which no path leads stays one. */
  vectors: (VectorRequest | null)[];
  /** A factor for each vector. None of them may be `null` or without a path. */
  combine?: number[];
};

export type TransportAnswer = {
  from: PointAnswer;
  to: PointAnswer;
  distance: (number | null);
  reason?: "no_path";
  /** `null` when there is no path. */
  vectors: (TangentVector[] | null);
};

export type MeanRequest = {
  points: Point[];
  /** One for each point, not all 0; equal ones by default. */
  weights?: number[];
  method?: ("karcher" | "one_step");
};

export type MeanAnswer = {
  point: PointAnswer;
  residual: number;
  spread: number;
  iterations: number;
  converged: boolean;
  cut_locus: boolean;
};

/** At most one of `samples`, `tolerance` and `spacing`. */
export type SplineCurve = {
  points: Point[];
  /** The last point is joined to the first, which is not repeated. */
  closed?: boolean;
  /** 0 uniform, 0.5 centripetal, 1 chordal. */
  alpha?: number;
  /** At 1 the curve is a geodesic polyline. */
  tension?: number;
  tangent_rule?: ("symmetric" | "paper");
  end_rule?: ("natural" | "zero");
  /** One for each point, by unit of the parameter; `null`: by the rules. A vector that `log` answers will do as it is: its direction and length count. */
  tangents?: ({
    direction: (DirectionRequest | null);
    length: number;
    reason?: string;
    cut_locus?: boolean;
    segments?: unknown[];
  } | null)[];
  /** A segment; at most 100000 in all. */
  samples?: number;
  /** With `samples` only. */
  speed?: ("parameter" | "constant");
  tolerance?: number;
  spacing?: number;
};

/** At most one of `samples`, `tolerance`, `spacing` and `at`. */
export type SplineRequest = {
  points: Point[];
  /** The last point is joined to the first, which is not repeated. */
  closed?: boolean;
  /** 0 uniform, 0.5 centripetal, 1 chordal. */
  alpha?: number;
  /** At 1 the curve is a geodesic polyline. */
  tension?: number;
  tangent_rule?: ("symmetric" | "paper");
  end_rule?: ("natural" | "zero");
  /** One for each point, by unit of the parameter; `null`: by the rules. */
  tangents?: ({
    direction: DirectionRequest;
    length: number;
  } | null)[];
  /** A segment; at most 100000 in all. */
  samples?: number;
  /** With `samples` only. */
  speed?: ("parameter" | "constant");
  tolerance?: number;
  spacing?: number;
  /** Ascending, from 0 to the last of the answer's `parameters`. */
  at?: number[];
  frames?: boolean;
};

export type SplineAnswer = {
  path: Path;
  segments: Array<{
    control_points: [PointAnswer, PointAnswer, PointAnswer, PointAnswer];
    /** Between its ends. */
    distance: number;
    clipped: boolean;
    cut_locus: boolean;
  }>;
  /** Of the points; of a closed curve the first one's again, after a whole round. */
  parameters: number[];
  /** One a point. */
  joints: Array<{
    tangent: TangentVector;
    angle_jump: number;
    speed_jump: number;
  }>;
  /** When they are asked for. */
  frames?: Array<{
    parameter: number;
    xyz: Vector;
    tangent: Vector;
    normal: Vector;
    binormal: Vector;
    speed: number;
  }>;
};

export type CurveOperationRequest = {
  curve: Curve;
  operation: ("length" | "resample" | "shorten" | "closed-geodesic" | "offset");
  /** Of `resample`. */
  count?: number;
  /** Of `shorten`; left out: until it is a geodesic. */
  rounds?: number;
  /** Of `shorten`, with `rounds`. */
  pieces?: number;
  /** Of `offset`. */
  distance?: number;
  /** Of `offset`. */
  tolerance?: number;
};

/** The members depend on the operation. */
export type CurveOperationAnswer = {
  path?: Path;
  /** Of `resample`. */
  points?: PointAnswer[];
  /** Of `shorten` and `closed-geodesic`, as the next two. */
  turn?: number;
  rounds?: number;
  geodesic?: boolean;
  /** Of `offset`. */
  paths?: Array<{
    closed: boolean;
    path: Path;
  }>;
};

export type SamplingRequest = {
  count: number;
  /** The first point; by default the vertex of least index that faces refer to. */
  start?: Point;
};

export type SamplingAnswer = {
  /** With `geometry=xyz` as [x,y,z]. */
  points?: (PointAnswer | Vector)[];
  /** Entry i is the covering radius of points 0 to i: how far the surface's farthest point is from the nearest of them, which is the distance of point i + 1 to those before it. It never grows; null as long as a component has no point. */
  radii: (number | null)[];
};

export type Isoline = {
  level: number;
  lines: Array<{
    closed: boolean;
    /** Of the line itself, not of its polyline. */
    length: number;
    /** A polyline as in a path: where the line crosses edges, where arcs meet in faces, and points of the arcs between, as many as the tolerance takes. A closed one ends in its first point. With `arcs` and no tolerance: arc i runs from point i to point i + 1. */
    points?: (PathPoint | Vector)[];
    arcs?: Arc[];
  }>;
};

/** A circular arc in the plane of a face, counter-clockwise (seen from outside) from angle `start`, in [0, 2 pi), to `end`. Angles are counted about the centre as those of directions in the face are: from its first edge, from its first corner to its second in the file's order. So with x the unit vector of that edge and y the one at right angles to it to its left in the face's plane, the arc's points are centre + radius (cos(angle) x + sin(angle) y). Or, of a source that is a curve, `straight` from point to point. */
export type Arc = ({
  face: number;
  /** Where the source lies when it is unfolded into the plane; mostly outside the face. */
  centre: Vector;
  radius: number;
  start: number;
  end: number;
} | {
  face: number;
  straight: true;
});

export type WedgesAnswer = {
  edge: Edge;
  wedges: Array<{
    b0: number;
    b1: number;
    /** Distance of the pseudo-source to the wedge's beginning. */
    d0: number;
    /** And to its end. */
    d1: number;
    /** Distance of the pseudo-source itself. */
    sigma: number;
    /** Whether the pseudo-source lies to the left of the edge from its lower vertex. */
    tau: boolean;
    /** Of a segment of a curve, which is seen at right angles all along: the distance grows evenly from d0 to d1. Else it is left out. */
    linear?: true;
    /** The pseudo-source, a vertex of the mesh or a member of the set. */
    source: {
      vertex?: Index;
      member?: Index;
    };
  }>;
};

export type MeshJson = {
  vertices: Vector[];
  faces: Array<Index[]>;
};

export type MeshList = {
  meshes: Mesh[];
  /** `after` of the next page; `null`: this is the last. */
  next: (string | null);
};

export type BoundaryLoop = {
  vertices: Count;
  length: number;
};

export type Mesh = {
  name: Name;
  /** Of the uploaded bytes. */
  sha256: string;
  /** Vertices of the upload, unreferenced ones included, and the copies that `repair` appended. */
  index_count: number;
  /** Vertices that faces use. */
  vertices: number;
  /** Triangles. */
  faces: number;
  edges: Count;
  components: Count;
  /** Boundary loops. Not there while the mesh is not in memory and was stored by a version before this member. */
  boundary_count?: number;
  /** The first of them; `/v1/meshes/{name}/boundaries` lists all. */
  boundaries: BoundaryLoop[];
  euler_characteristic: number;
  /** Sum over the components. */
  genus: number;
  orientation: {
    /** Turned over to make the orientation consistent. */
    flipped_faces: number;
  };
  area: number;
  bounding_box: {
    min: Vector;
    max: Vector;
  };
  edge_length: {
    min: number;
    mean: number;
    max: number;
  };
  /** Nearly degenerate faces (height less than 1e-6 of the longest edge). They are answered; faces without area are refused. */
  degenerate_faces: number;
  /** Interior vertices with a total angle over 2 pi. */
  saddle_vertices: number;
  unreferenced_vertices: Count;
  repair: {
    /** Edges of more than two faces that were cut. */
    edges_split: number;
    /** Vertices that got copies. */
    vertices_split: number;
    /** Indices that `weld` let name another vertex. */
    vertices_welded: number;
    /** Indices that name another vertex because an edge of length zero joined the two (or one of less than 1e-6 of the longest edge of a face without area). */
    vertices_merged: number;
    /** Face indices unused because an earlier face has the same vertices. */
    duplicate_faces: number;
    /** Face indices unused because nothing was left of the face, or it had no area and no single neighbour over its longest edge. */
    degenerate_faces: number;
    /** Longest edges of faces without area. */
    edges_flipped: number;
    /** Length by which a point of the surface may have moved: how far vertices were welded or merged, and the heights of flipped faces. */
    largest_shift: number;
    /** Copies in all. They have the last indices, up to `index_count`. */
    vertices_copied: number;
    /** The first copies, each with the vertex that it is a copy of. */
    copies: IndexPair[];
    /** The first elements of each kind that is there. */
    first: {
      /** The edge's vertices. */
      edges_split?: IndexPair[];
      /** The vertex and how many copies it got. */
      vertices_split?: IndexPair[];
      /** The index and the vertex that it names. */
      vertices_welded?: IndexPair[];
      /** The index and the vertex that it names. */
      vertices_merged?: IndexPair[];
      /** The face removed and the one that stays. */
      duplicate_faces?: IndexPair[];
      /** The face removed. */
      degenerate_faces?: Index[];
      /** The face without area and its neighbour. */
      edges_flipped?: IndexPair[];
    };
  };
  memory_bytes: Count;
  fields_cached: Count;
  created: string;
  /** As in the ETag header but for its quotes. */
  etag: string;
};

/** Parameters [u, v]. In a closed direction any number, in others one of the domain. */
export type Place = [number, number];

/** Not decreasing. */
export type Knots = number[];

export type Interval = [number, number];

export type SubdivisionJson = (MeshJson | {
  points: Vector[];
  faceVertexCounts: Count[];
  faceVertexIndices: Index[];
  /** The vertices of chains of edges, one chain after the other. */
  creaseIndices?: Index[];
  /** How many vertices each chain has. */
  creaseLengths?: number[];
  /** One a chain, or one an edge; from 10 on for ever. */
  creaseSharpnesses?: number[];
  cornerIndices?: Index[];
  cornerSharpnesses?: number[];
  /** `none` only where there is no boundary. */
  interpolateBoundary?: ("edgeAndCorner" | "edgeOnly" | "none");
  subdivisionScheme?: ("catmullClark" | "loop");
});

export type Subdivision = {
  name: Name;
  /** Of the uploaded bytes. */
  sha256: string;
  scheme: ("catmull_clark" | "loop");
  /** Of the control mesh; so are edges and faces. */
  vertices: Count;
  edges: Count;
  faces: Count;
  /** Inside, of another valence than 4 (Loop: 6). */
  extraordinary_vertices: Array<{
    valence: Count;
    count: Count;
  }>;
  /** Edges and vertices with a tag; no boundary edges. */
  crease_edges: Count;
  corner_vertices: Count;
  boundary_edges: Count;
  /** Loops of them. */
  boundaries: Count;
  /** Of a discretization: 1 where there are polygons that are no quads. */
  least_level: Count;
  /** The one that queries use when none is said. */
  usual_level: Count;
  memory_bytes: Count;
  created: string;
  /** As in the ETag header but for its quotes. */
  etag: string;
};

export type SubdivisionList = {
  subdivisions: Subdivision[];
  /** `after` of the next page; `null`: this is the last. */
  next: (string | null);
};

/** A place of the limit surface, by a face of the control mesh: u from its first corner to the second, v from the first to the fourth (Loop: to the third, u + v at most 1). A polygon of n != 4 corners is n pieces, one a `corner`: u from that corner to the middle of the next edge, v to that of the one before, (1,1) in the middle of the face. */
export type LimitPlace = {
  face: Index;
  uv: [number, number];
  /** 0 when it is left out. */
  corner?: Index;
};

export type LimitPoint = {
  face: Index;
  corner?: Index;
  uv: [number, number];
  xyz: Vector;
};

export type LimitEvaluateRequest = {
  points: LimitPlace[];
};

export type LimitEvaluateAnswer = {
  points: Array<{
    xyz: Vector;
    normal: (Vector | null);
    du: (Vector | null);
    dv: (Vector | null);
    duu: (Vector | null);
    duv: (Vector | null);
    dvv: (Vector | null);
    curvatures: ([number, number] | null);
    /** Only there when it is true. */
    singular?: boolean;
  }>;
};

export type LimitFootAnswer = {
  face: Index;
  corner?: Index;
  uv: [number, number];
  xyz: Vector;
  distance: number;
};

/** One of `directions` and `fan`. */
export type LimitTraceRequest = {
  start: LimitPlace;
  directions?: DirectionRequest[];
  /** So many directions at equal angles all around, from zero. */
  fan?: number;
  length: number;
  vertex_rule?: ("bisect" | "limit_normal");
  /** On the surface itself. */
  smooth?: boolean;
  /** Of the discretization: edges of the control mesh are cut into 2^level. From `least_level` on; by default `usual_level`, both in the description. */
  level?: number;
};

export type LimitTraceAnswer = {
  start: LimitPoint;
  /** Unless it is smooth. */
  level?: Count;
  paths: Array<{
    length: number;
    points?: LimitPoints;
    end_direction: LimitDirection;
    end_reason: ("length" | "boundary" | "singular" | "step_limit");
  }>;
};

/** A direction at a place, in both forms. Zero is that of the face's first edge (du). */
export type LimitDirection = {
  /** `null`: the surface has no normal there. */
  angle: (number | null);
  xyz: Vector;
};

export type LimitPoints = (LimitPoint | Vector)[];

export type LimitPairRequest = {
  from: LimitPlace;
  to: LimitPlace;
  /** Of the discretization: edges of the control mesh are cut into 2^level. From `least_level` on; by default `usual_level`, both in the description. */
  level?: number;
};

export type LimitPairAnswer = {
  distance: (number | null);
  reason?: "no_path";
  error_estimate?: number;
  /** The path is a geodesic of the limit surface. */
  relaxed?: boolean;
  mesh_distance?: number;
  level: Count;
  from: LimitPoint;
  to: LimitPoint;
  path?: ({
    length: number;
    points?: LimitPoints;
  } | null);
};

/** Either `level` or `tolerance`. */
export type DiscretizeRequest = {
  mesh: Name;
  /** Of the discretization: edges of the control mesh are cut into 2^level. From `least_level` on; by default `usual_level`, both in the description. */
  level?: number;
  /** A length. */
  tolerance?: number;
};

export type VertexPlaces = {
  /** The surface that the mesh was made of, in the version that it had then. */
  subdivision: {
    name: Name;
    etag: string;
  };
  places: Array<[number, number, number, number]>;
};

export type NurbsFile = ({
  degreeU: number;
  degreeV: number;
  knotsU: Knots;
  knotsV: Knots;
  /** Row i goes with u, element j of it with v: [x, y, z], or all of them [x, y, z, weight]. At most 4096 x 4096. */
  controlPoints: Array<Array<number[]>>;
  /** More than 0, as many as control points. All 1 by default. */
  weights?: Array<number[]>;
  convention?: ("canonical" | "three" | "verb" | "rhino");
} | {
  parametric: {
    /** ((major + minor cos v) cos u, (major + minor cos v) sin u, minor sin v), minor < major. */
    torus?: {
      major: number;
      minor: number;
    };
    /** (v cos u, v sin u, pitch u). */
    helicoid?: {
      /** Not 0. */
      pitch: number;
      u: Interval;
      v: Interval;
    };
    /** (u, v, sum of coefficients[i][j] u^i v^j), rows of equal length; the degrees are at most 16. */
    graph?: {
      coefficients: Array<number[]>;
      u: Interval;
      v: Interval;
    };
    /** (r(v) cos u, r(v) sin u, h(v)): control points are [radius, height] of a B-spline or, with weights, a NURBS curve. An end on the axis is a pole. */
    revolution?: {
      degree: number;
      knots: Knots;
      control_points: Interval[];
      weights?: number[];
    };
  };
});

export type NurbsAxis = {
  range: Interval;
  /** The two borders are one curve; any parameter is taken, with the range as the period. */
  closed: boolean;
  /** Smooth pieces of the range; the surface may have kinks in its derivatives between them. */
  pieces: number;
  /** The whole border at the range's lower end is one point. */
  pole_low: boolean;
  /** The same at its upper end. */
  pole_high: boolean;
};

export type Nurbs = {
  name: Name;
  /** Of the uploaded bytes. */
  sha256: string;
  /** What the file said. Of `nurbs` only the next four are there. */
  shape: ("nurbs" | "torus" | "helicoid" | "graph" | "revolution");
  convention?: ("canonical" | "three" | "verb" | "rhino");
  degree?: [Count, Count];
  /** How many in u and in v. */
  control_points?: [Count, Count];
  /** The weights differ. */
  rational?: boolean;
  domain: {
    u: NurbsAxis;
    v: NurbsAxis;
  };
  /** A length of the order of the extent: the diagonal of the box of some of its points. */
  size: number;
  /** Shortest paths can be asked for. */
  geodesics: boolean;
  /** Of the tessellation that they are first looked for on; absent where there is none. */
  seeding_faces?: number;
  /** Why there is none. */
  reason?: string;
  memory_bytes: Count;
  created: string;
  /** As in the ETag header but for its quotes. */
  etag: string;
};

export type NurbsList = {
  nurbs: Nurbs[];
  /** `after` of the next page; `null`: this is the last. */
  next: (string | null);
};

export type VertexParameters = {
  /** The surface that the mesh was made of, in the version that it had then. */
  nurbs: {
    name: Name;
    etag: string;
  };
  /** Of u and of v; `null`: the direction is not closed. */
  periods: [(number | null), (number | null)];
  uv: Place[];
};

export type EvaluateRequest = {
  uv: Place[];
};

export type EvaluateAnswer = {
  points: Array<{
    xyz: Vector;
    normal: (Vector | null);
    du: Vector;
    dv: Vector;
    duu: Vector;
    duv: Vector;
    dvv: Vector;
    gaussian_curvature: (number | null);
    mean_curvature: (number | null);
  }>;
};

export type FootRequest = {
  xyz: Vector;
};

export type FootAnswer = {
  uv: Place;
  xyz: Vector;
  distance: number;
};

/** A curve in the domain: one of `polyline`, `bspline` and `iso`. Its parameter is along a polyline the number of the corner, of a B-spline that of its knots, of an iso line the other coordinate. A curve whose ends are one place of the surface is closed in any case. */
export type DomainCurve = ({
  polyline: Place[];
  /** From the last corner to the first. */
  closed?: boolean;
} | {
  bspline: {
    degree: number;
    knots: Knots;
    control_points: Place[];
  };
  /** `true` refuses a B-spline that does not end where it begins. */
  closed?: boolean;
} | {
  /** The parameter that stays the same. */
  iso: ("u" | "v");
  value: number;
  /** Of the other parameter; all of it by default. */
  range?: Interval;
});

/** Degree of the spline. */
export type SplineDegree = number;

/** Count of one spline over all knot lines; more than the degree. By default as many as the tolerance needs. */
export type SplineControlPoints = number;

/** Relative error of the length. */
export type LengthTolerance = number;

/** Answer every local minimum that was found. */
export type AllMinima = boolean;

/** Number of points in the answer's `points`. */
export type PathSamples = number;

export type GeodesicRequest = {
  from: Place;
  to: Place;
  degree?: SplineDegree;
  control_points?: SplineControlPoints;
  tolerance?: LengthTolerance;
  all_minima?: AllMinima;
  samples?: PathSamples;
};

export type PointCurveRequest = {
  point: Place;
  curve: DomainCurve;
  degree?: SplineDegree;
  control_points?: SplineControlPoints;
  tolerance?: LengthTolerance;
  all_minima?: AllMinima;
  samples?: PathSamples;
};

export type NurbsCurveDistanceRequest = {
  a: DomainCurve;
  b: DomainCurve;
  degree?: SplineDegree;
  control_points?: SplineControlPoints;
  tolerance?: LengthTolerance;
  all_minima?: AllMinima;
  samples?: PathSamples;
};

export type GeodesicEnd = {
  /** On the curve. */
  parameter?: number;
  uv: Place;
  xyz: Vector;
  /** Between path and curve; `null` where the path has length 0. */
  angle?: (number | null);
};

export type GeodesicAnswer = {
  length: number;
  /** Absent where the length is 0. */
  degree?: number;
  /** From 0 to the number of pieces. Where two pieces meet the knot has the multiplicity of the degree, at a pole one more. */
  knots: number[];
  control_points: Place[];
  /** At even parameters of the spline, from its beginning to its end. */
  points?: (Vector | {
    uv: Place;
    xyz: Vector;
  })[];
  /** `from` and `to` of `geodesic`, `curve` of `point-curve-distance`, `a` and `b` of `curve-distance`. */
  ends: {
    from?: GeodesicEnd;
    to?: GeodesicEnd;
    curve?: GeodesicEnd;
    a?: GeodesicEnd;
    b?: GeodesicEnd;
  };
  /** Norm of the gradient of the length, relative. */
  residual: number;
  /** Of the length, in its unit. */
  error_estimate: number;
  /** Integral of its square along the path: 0 for an exact geodesic. */
  geodesic_curvature: number;
  /** How uneven the speed is: (2 E - L^2) / L^2 with the energy E. */
  speed_defect: number;
  iterations: Count;
  /** The tolerance is met. */
  converged: boolean;
  /** Proved to be a local minimum. */
  is_minimum: boolean;
  boundary_contact: boolean;
  warnings: ("not_converged" | "boundary_contact" | "curve_corner" | "through_pole" | "not_minimal")[];
  /** With `all_minima`: the local minima by length, each in the form of this answer. */
  minima?: GeodesicAnswer[];
};

/** Either `tolerance` or `resolution`. */
export type TessellateRequest = {
  mesh: Name;
  /** A length. */
  tolerance?: number;
  /** Parts in u and in v. */
  resolution?: [number, number];
};

export type Service = {
  version: string;
  limits: {
    max_body_bytes: Count;
    max_faces: Count;
    timeout_ms: Count;
    memory_budget_bytes: Count;
    /** Of an answer that is not a stream. */
    max_answer_bytes: Count;
    workers: Count;
  };
  capabilities: {
    formats: string[];
    queries: string[];
  };
};

export type Health = {
  /** read_only means that a write to the disk failed: reads go on, changes are refused with 507. degraded means that the database of `--store` does not answer: meshes in memory can be asked about, all else is refused with 503. */
  status: ("ok" | "starting" | "draining" | "read_only" | "degraded");
  /** Why the store is read-only or out of reach. */
  reason?: string;
};

export type Job = {
  id: JobId;
  /** `done` and `failed` have an answer. */
  state: ("queued" | "running" | "done" | "failed" | "cancelled");
  /** The part of the work that is done, as the engine counts it (faces reached, rows finished); it never falls. A job that waits for work which another one began stays where it is. */
  progress: number;
  created: string;
  /** Method and path of what was asked. */
  request: string;
  /** The head of the answer. */
  response?: {
    status: number;
    media_type: (string | null);
    bytes: Count;
    headers: Record<string, string>;
  };
  /** What the operation answered; instead of what is no JSON, a link to it. Not in lists and events. */
  result?: unknown;
  /** Why the operation failed. Not in lists. */
  problem?: Problem;
};

export type JobList = {
  jobs: Job[];
  /** `after` of the next page; `null`: this is the last. */
  next: (string | null);
};

/** RFC 9457. */
export type Problem = {
  type: string;
  title: string;
  status: number;
  /** One sentence that tells what to change. */
  detail: string;
  code: ("invalid_request" | "unauthorized" | "forbidden" | "not_found" | "method_not_allowed" | "not_acceptable" | "conflict" | "field_evicted" | "length_required" | "precondition_failed" | "too_large" | "unsupported_media_type" | "invalid_mesh" | "point_not_on_surface" | "rate_limited" | "internal" | "overloaded" | "draining" | "store_unavailable" | "deadline_exceeded" | "insufficient_memory" | "insufficient_storage");
  /** Into the body. */
  pointer?: string;
  /** Name in the query string. */
  parameter?: string;
  /** Why a mesh was refused. */
  reason?: string;
  /** The configured maximum that was passed. */
  limit?: number;
  /** The first offending ones. */
  elements?: Array<{
    vertex?: Count;
    edge?: Edge;
    face?: Count;
    line?: Count;
    byte?: Count;
  }>;
};

/** What can be asked of `/v1/meshes/{name}`, by its name: what is sent and what comes back. */
export interface MeshQueries {
  /** Get the geodesic distance between two points */
  "distance": {
    body: PairRequest;
    answer: DistanceAnswer;
  };
  /** Get the shortest path between two points */
  "path": {
    body: PairRequest;
    answer: PathAnswer;
  };
  /** Locate a point on the surface */
  "nearest": {
    body: NearestRequest;
    answer: PointAnswer;
  };
  /** Get the distances from each source to each target */
  "matrix": {
    body: MatrixRequest;
    answer: MatrixAnswer;
  };
  /** Get the distances of points to a set */
  "distance-to-set": {
    body: SetDistanceRequest;
    answer: ResultsAnswer;
  };
  /** Get the least or the Hausdorff distance of two curves */
  "curve-distance": {
    body: CurveDistanceRequest;
    answer: CurveDistanceAnswer;
  };
  /** Compute the distances from a set to the whole surface */
  "fields": {
    body: FieldRequest;
    answer: Field;
  };
  /** Get the Voronoi diagram of a set */
  "voronoi": {
    body: VoronoiRequest;
    answer: VoronoiAnswer;
  };
  /** Sample the surface evenly by farthest points */
  "farthest-points": {
    body: SamplingRequest;
    answer: SamplingAnswer;
  };
  /** Trace straightest geodesics from a point */
  "trace": {
    body: TraceRequest;
    answer: TraceAnswer;
  };
  /** Get the end points of vectors (exponential map) */
  "exp": {
    body: ExpRequest;
    answer: ExpAnswer;
  };
  /** Get the vectors to points (logarithmic map) */
  "log": {
    body: LogRequest;
    answer: LogAnswer;
  };
  /** Transport vectors to another point */
  "transport": {
    body: TransportRequest;
    answer: TransportAnswer;
  };
  /** Get the weighted mean of points */
  "mean": {
    body: MeanRequest;
    answer: MeanAnswer;
  };
  /** Get a smooth curve through points */
  "spline": {
    body: SplineRequest;
    answer: SplineAnswer;
  };
  /** Measure, resample, shorten or offset a curve */
  "curve": {
    body: CurveOperationRequest;
    answer: CurveOperationAnswer;
  };
  /** Cut a mesh along a curve into new meshes */
  "cut": {
    body: CutRequest;
    answer: CutAnswer;
  };
}

/** What can be asked of `/v1/subdivisions/{name}`, by its name: what is sent and what comes back. */
export interface SubdivisionQueries {
  /** Position, derivatives, normal and principal curvatures of the limit surface */
  "evaluate": {
    body: LimitEvaluateRequest;
    answer: LimitEvaluateAnswer;
  };
  /** The point of the limit surface nearest to a point of space */
  "nearest": {
    body: FootRequest;
    answer: LimitFootAnswer;
  };
  /** Geodesics from a place */
  "trace": {
    body: LimitTraceRequest;
    answer: LimitTraceAnswer;
  };
  /** The distance between two places */
  "distance": {
    body: LimitPairRequest;
    answer: LimitPairAnswer;
  };
  /** The shortest path between two places */
  "path": {
    body: LimitPairRequest;
    answer: LimitPairAnswer;
  };
  /** The surface as a mesh whose vertices lie on it and remember where */
  "discretize": {
    body: DiscretizeRequest;
    answer: Mesh;
  };
}

/** What can be asked of `/v1/nurbs/{name}`, by its name: what is sent and what comes back. */
export interface NurbsQueries {
  /** Position, derivatives, normal and curvatures at places of the domain */
  "evaluate": {
    body: EvaluateRequest;
    answer: EvaluateAnswer;
  };
  /** The point of the surface nearest to a point of space */
  "nearest": {
    body: FootRequest;
    answer: FootAnswer;
  };
  /** The shortest path between two points of the surface */
  "geodesic": {
    body: GeodesicRequest;
    answer: GeodesicAnswer;
  };
  /** The shortest path from a point to a curve on the surface */
  "point-curve-distance": {
    body: PointCurveRequest;
    answer: GeodesicAnswer;
  };
  /** The shortest path between two curves on the surface */
  "curve-distance": {
    body: NurbsCurveDistanceRequest;
    answer: GeodesicAnswer;
  };
  /** The surface as a mesh whose vertices remember their places */
  "tessellate": {
    body: TessellateRequest;
    answer: Mesh;
  };
}

