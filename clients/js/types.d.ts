// generate.py makes this file from proto/openapi.yaml; do not edit it.

export type BatchRequest = (AllPairsBatchRequest | FieldsBatchRequest);

export type AllPairsBatchRequest = {
  query: "all-pairs";
  mesh: Name;
  vertices: Index[];
};

export type FieldsBatchRequest = {
  query: "fields";
  meshes: Name[];
  set: Set;
  max_distance?: number;
};

export type Batch = {
  id: JobId;
  state: BatchState;
  items: Count;
  /** Number of items that have an answer. */
  done: number;
  /** Number of answers that are problems. */
  failed: number;
  progress: number;
  created: string;
};

/** `done`: every item has an answer. `cancelled`: there will be no further answers. */
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
    /** The answer of the item: that of `matrix`, or of `POST …/fields`. */
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

/** The two vertices of an edge. */
export type Edge = [Index, Index];

/** A point in exactly one of five forms, or a text as in URLs. */
export type Point = (CompactPoint | VertexPoint | EdgePoint | FacePoint | SpacePoint | RayPoint);

export type VertexPoint = {
  vertex: Index;
};

export type EdgePoint = {
  edge: Edge;
  /** Fraction of the edge, from the first listed vertex. */
  t: number;
};

export type FacePoint = {
  face: Index;
  barycentric: Vector;
};

/** The nearest point of the surface. */
export type SpacePoint = {
  xyz: Vector;
  /** Greatest allowed distance from the surface; by default any distance. */
  max_snap?: number;
};

/** The first hit of the ray. */
export type RayPoint = {
  ray: Ray;
};

export type Ray = {
  origin: Vector;
  direction: Vector;
};

/**
 * `v:12` is a vertex; `e:3-9:0.25` an edge, and the fraction t of its length from the first listed
 * vertex; `f:34:0.2,0.3,0.5` a face and barycentric coordinates; `p:1.0,2.0,3.0` the surface point
 * nearest to these coordinates. Indices have no leading zeros.
 */
export type CompactPoint = string;

/** Compact points separated by semicolons. */
export type CompactPoints = string;

/**
 * A point in all its forms. A point at a vertex has `vertex`, and a point on an edge has `edge` and
 * `t`. At a vertex or on an edge, `face` is the lowest-numbered adjacent face. `snap_distance` is
 * the distance from the requested position in space.
 */
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
  /** Points that the path visits, in this order. */
  via?: Point[];
};

/** The distance. If there is none, it is `null`, and `reason` has the cause. */
export type Distance = (number | null);

/** `no_path`: the two points, or two consecutive ones, lie on different components. */
export type Reason = "no_path";

export type DistanceAnswer = {
  distance: Distance;
  reason?: Reason;
  from: PointAnswer;
  to: PointAnswer;
  /** Present if the request has such points. */
  via?: PointAnswer[];
};

export type PathAnswer = {
  distance: Distance;
  reason?: Reason;
  from: PointAnswer;
  to: PointAnswer;
  /** Present if the request has such points. */
  via?: PointAnswer[];
  /** The path; `null` if there is none. */
  path: (Path | null);
};

export type MatrixRequest = {
  sources: MatrixPoints;
  targets: MatrixPoints;
  /** Greatest distance to compute. A lower value saves time. */
  max_distance?: number;
};

/** At most 4,000,000 pairs of a source and a target. */
export type MatrixPoints = Point[];

export type MatrixAnswer = {
  /** A row per source, in the order of the request, with a distance per target. */
  distances: Array<Distance[]>;
  /**
   * Present if a distance is `null`. It has the shape of `distances`, with the reason for each
   * distance that is `null`, and `null` for each other distance. `no_path`: the two points lie on
   * different components. `beyond_max_distance`: their distance exceeds `max_distance`.
   */
  reasons?: ("no_path" | "beyond_max_distance" | null)[][];
};

export type PairsRequest = {
  from?: BulkPoints;
  to?: BulkPoints;
  /** Pairs of points. Replaces `from` and `to`. */
  pairs?: Array<[Point, Point]>;
};

export type PairsAnswer = {
  /** A distance per pair; `null` where there is no path between the points. */
  distances: Distance[];
};

export type NearestPointsRequest = {
  points: BulkPoints;
};

export type NearestPointsAnswer = {
  faces: number[];
  barycentric: Array<[number, number, number]>;
  xyz: Array<[number, number, number]>;
  /**
   * Distance by which each point was moved to the surface; `null` for points given by a vertex, an
   * edge or a face.
   */
  snap_distances: (number | null)[];
};

export type BulkPoints = Point[];

/**
 * The body of a query. It also has the name of the query, and may have parameters of its query
 * string.
 */
export type BatchLine = (BatchPair | BatchNearest | BatchMatrix | BatchSetDistance | BatchCurveDistance | BatchSpline | BatchTrace | BatchTransport | BatchVoronoi);

/** Members of the answer to return, as `a,b` or as an array. */
export type BatchNames = (string | string[]);

/** Former name of `select`. */
export type BatchFormerNames = (string | string[]);

export type BatchPair = {
  query: ("distance" | "path");
  select?: BatchNames;
  fields?: BatchFormerNames;
  geometry?: ("full" | "xyz" | "none");
  from: Point;
  to: Point;
  via?: Point[];
};

export type BatchNearest = {
  query: "nearest";
  select?: BatchNames;
  fields?: BatchFormerNames;
  geometry?: ("full" | "xyz" | "none");
  point: Point;
};

export type BatchMatrix = {
  query: "matrix";
  select?: BatchNames;
  fields?: BatchFormerNames;
  geometry?: ("full" | "xyz" | "none");
  sources: MatrixPoints;
  targets: MatrixPoints;
  max_distance?: number;
};

export type BatchCurveDistance = {
  query: "curve-distance";
  select?: BatchNames;
  fields?: BatchFormerNames;
  geometry?: ("full" | "xyz" | "none");
  a: Curve;
  b: Curve;
  measure?: ("min" | "hausdorff");
};

export type BatchSetDistance = {
  query: "distance-to-set";
  select?: BatchNames;
  fields?: BatchFormerNames;
  geometry?: ("full" | "xyz" | "none");
  set: Set;
  points: EvaluationPoints;
  path?: boolean;
};

/** At most one of `samples`, `tolerance`, `spacing` and `at`. */
export type BatchSpline = {
  query: "spline";
  select?: BatchNames;
  fields?: BatchFormerNames;
  geometry?: ("full" | "xyz" | "none");
  points: Point[];
  /** Joins the last point to the first. The list does not repeat the first point. */
  closed?: boolean;
  /** 0 uniform, 0.5 centripetal, 1 chordal. */
  alpha?: number;
  /** With 1 the curve is a geodesic polyline. */
  tension?: number;
  tangent_rule?: ("symmetric" | "paper");
  end_rule?: ("natural" | "zero");
  /** `de_casteljau` needs `samples` or `at`, and no constant `speed`. */
  evaluation?: ("halving" | "de_casteljau");
  /** A tangent for each point, per unit of the parameter; `null` selects the rule. */
  tangents?: ({
    direction: DirectionRequest;
    length: number;
  } | null)[];
  /** Samples per segment, at most 100,000 in total. */
  samples?: number;
  /** Allowed only with `samples`. */
  speed?: ("parameter" | "constant");
  tolerance?: number;
  spacing?: number;
  /** Parameters in ascending order, from 0 to the last of the answer's `parameters`. */
  at?: number[];
  frames?: boolean;
};

/** Either `directions` or `fan`. */
export type BatchTrace = {
  query: "trace";
  select?: BatchNames;
  fields?: BatchFormerNames;
  geometry?: ("full" | "xyz" | "none");
  start: Point;
  directions?: DirectionRequest[];
  /**
   * Number of directions at equal angles around the point, starting at zero. At a boundary point,
   * they extend from one side of the boundary to the other.
   */
  fan?: number;
  length: number;
  vertex_rule?: ("bisect" | "limit_normal");
  boundary_rule?: ("stop" | "slide");
  /** Ends the line where it crosses or touches itself. */
  stop_at_self_intersection?: boolean;
  step_limit?: number;
};

export type BatchTransport = {
  query: "transport";
  select?: BatchNames;
  fields?: BatchFormerNames;
  geometry?: ("full" | "xyz" | "none");
  from: Point;
  to: Point;
  /**
   * Each vector has a direction and a length, or one segment. For a vector without a path, the
   * result has no path either.
   */
  vectors: (VectorRequest | null)[];
  /** A factor for each vector. `null`, and vectors without a path, are rejected. */
  combine?: number[];
};

export type BatchVoronoi = {
  query: "voronoi";
  select?: BatchNames;
  fields?: BatchFormerNames;
  geometry?: ("full" | "xyz" | "none");
  set: Set;
  /**
   * Greatest distance between a bisector and the polyline that approximates it, in the unit of the
   * mesh. The default is 1/2000 of the diagonal of the mesh's bounding box.
   */
  tolerance?: number;
};

/**
 * The answer of the query with `status` 200, or a problem. In a problem, `elements` has the number
 * of the line, and `pointer` points into the line.
 */
export type BatchAnswer = (BatchPairAnswer | BatchNearestAnswer | BatchMatrixAnswer | BatchSetDistanceAnswer | BatchCurveDistanceAnswer | BatchSplineAnswer | BatchTraceAnswer | BatchTransportAnswer | BatchVoronoiAnswer | Problem);

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

export type BatchSplineAnswer = {
  status: 200;
  path?: Path;
  segments?: Array<{
    control_points: [PointAnswer, PointAnswer, PointAnswer, PointAnswer];
    /** Distance between the ends of the segment. */
    distance: number;
    clipped: boolean;
    cut_locus: boolean;
  }>;
  /**
   * Parameters of the points; for a closed curve also that of the first point after a full round.
   */
  parameters?: number[];
  /** One for each point. */
  joints?: Array<{
    tangent: TangentVector;
    /**
     * Angle in radians by which the curve turns at the point. Where its speed is 0 this is the
     * angle between the limits of its tangents. 0 at the ends of an open curve.
     */
    angle_jump: number;
    speed_jump: number;
  }>;
  /** Present if requested. */
  frames?: Array<{
    parameter: number;
    xyz: Vector;
    tangent: Vector;
    normal: Vector;
    binormal: Vector;
    speed: number;
  }>;
  /** The arc length between two samples, with `spacing` or `speed: constant`. */
  step?: number;
};

export type BatchTraceAnswer = {
  status: 200;
  start?: PointAnswer;
  paths?: TracedPath[];
};

export type BatchTransportAnswer = {
  status: 200;
  from?: PointAnswer;
  to?: PointAnswer;
  distance?: (number | null);
  reason?: "no_path";
  /** The vectors; `null` if there is no path. */
  vectors?: (TangentVector[] | null);
};

export type BatchVoronoiAnswer = {
  status: 200;
  /**
   * Number of the nearest member by vertex index; `null` for vertices without a path or without
   * faces.
   */
  labels?: (number | null)[];
  /** Ordered by their members. */
  bisectors?: Bisector[];
};

/**
 * A polyline on the surface from the first point to the last. Consecutive points lie in one face.
 */
export type Path = {
  length: number;
  points?: (PathPoint | Vector)[];
};

/**
 * A point with the element on which it lies: `vertex`, or `edge` and `t`, or `face` and
 * `barycentric`.
 */
export type PathPoint = {
  face?: Index;
  barycentric?: Vector;
  xyz: Vector;
  vertex?: Index;
  edge?: Edge;
  t?: number;
};

export type FieldId = string;

/**
 * A curve on the surface: points joined by shortest paths; vertices joined by edges; a boundary
 * loop, by its number in the mesh's description; or a spline, which is the path that `spline`
 * returns. Points that are joined by paths are moved onto an edge or a vertex if they lie within
 * 4e-12 of it in barycentric coordinates.
 */
export type Curve = (CurveOfPoints | CurveOfVertices | CurveOfBoundary | CurveOfSpline);

export type CurveOfPoints = {
  points: Point[];
  /** Joins the last point to the first. */
  closed?: boolean;
};

export type CurveOfVertices = {
  vertices: Index[];
  /** Joins the last vertex to the first. */
  closed?: boolean;
};

export type CurveOfBoundary = {
  boundary: Index;
};

export type CurveOfSpline = {
  spline: SplineCurve;
};

/**
 * The sources of distances. Members are numbered: points first, then curves, then boundaries. At
 * least one member is required. Distances to curves are exact; curves are not sampled.
 */
export type Set = {
  points?: (CompactPoint | Member)[];
  curves?: CurveMember[];
  /** All boundary loops of the mesh, or some loops by their numbers in its description. */
  boundaries?: ("all" | (Index | {
    boundary: Index;
    offset?: number;
    /** At most 128 bytes of UTF-8. */
    label?: string;
  })[]);
};

/** A curve, with an offset that is added to distances from it, and a label. */
export type CurveMember = {
  points?: Point[];
  vertices?: Index[];
  boundary?: Index;
  spline?: SplineCurve;
  /** Joins the last element to the first. */
  closed?: boolean;
  offset?: number;
  /** At most 128 bytes of UTF-8. */
  label?: string;
};

/**
 * A point in one of its five forms, with an offset that is added to distances from it, and a label.
 */
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

/** `closest` for `min`; `a_to_b`, `b_to_a` and `farthest` for `hausdorff`. */
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
  /**
   * `no_path`: no member lies on the component of the point. `beyond_max_distance`: the field ends
   * before the point.
   */
  reason?: ("no_path" | "beyond_max_distance");
  /**
   * The nearest member; `null` without a distance. If several members are equally near, one of
   * them.
   */
  nearest: ({
    index: Index;
    label: (string | null);
    point: PointAnswer;
  } | null);
  /** The path from the point to the nearest member, if requested; `null` if there is none. */
  path?: (Path | null);
  /**
   * Direction of growing distance, if requested: the straight continuation of the shortest path
   * that arrives at the point. At a vertex this direction has half of the total angle on either
   * side. At the boundary it may point away from the surface; then the vector lies in the plane of
   * the face through which the path arrives. It is `null` without a distance, and at a member,
   * where the distance grows in all directions.
   */
  gradient?: (Direction | null);
};

export type FieldRequest = {
  set: Set;
  /** Greatest distance to compute. A lower value saves time and memory. */
  max_distance?: number;
};

export type Field = {
  id: FieldId;
  /**
   * Number of stored wedges. With `max_distance`, the number may be that of a field of the same set
   * that reaches farther.
   */
  wedges: number;
  /** Memory of the wedges. */
  bytes: number;
  /** Total time of their computation. */
  build_ms: number;
  /**
   * Greatest distance. It is `null` if it exceeds `max_distance`, or if rounding makes this
   * uncertain.
   */
  max: (number | null);
  reason?: "beyond_max_distance";
  /** The point at the greatest distance; it may lie inside a face. */
  farthest: (PointAnswer | null);
  /** Number of members of the set. */
  members: number;
  max_distance: (number | null);
  /**
   * The `Set` of the request that created the field; `null` if its text is longer than 4,096 bytes.
   */
  set: (Record<string, unknown> | null);
  created: string;
  /** Number of requests that have used this field since it was created; in lists only. */
  uses?: number;
};

export type BoundaryList = {
  boundaries: BoundaryLoop[];
  /** The `after` of the next page; `null` on the last page. */
  next: (string | null);
};

export type FieldList = {
  fields: Field[];
  /** The `after` of the next page; `null` on the last page. */
  next: (string | null);
};

export type Values = {
  /**
   * Distances by vertex index; `null` for vertices without faces, without a path, or beyond
   * `max_distance`.
   */
  values: Distance[];
};

/**
 * A direction at a point of the surface, as an angle and as a unit vector `xyz` in the plane of the
 * face into which it leads. Angles grow counter-clockwise, seen from outside. Angle zero is: - in a
 * face, the direction of its first edge (from the first to the second corner, in the order of the
 * file); - on an edge, the direction from its lower to its higher vertex, with both faces unfolded;
 * - at an interior vertex, the edge to the lowest-numbered neighbour; angles are scaled to a total
 * of 2 pi; - at a boundary vertex, the boundary edge from which the faces follow counter-clockwise;
 * angles are not scaled.
 */
export type Direction = {
  angle: number;
  xyz: Vector;
};

/** Either `levels` or `count`. */
export type IsolinesRequest = {
  levels?: number[];
  /** Number of levels, evenly spaced between 0 and the field's maximum, both excluded. */
  count?: number;
  /**
   * Greatest distance between a line and the polyline that approximates it, in the unit of the
   * mesh. The default is that of GET.
   */
  tolerance?: number;
  arcs?: boolean;
};

export type IsolinesAnswer = {
  isolines: Isoline[];
};

export type CutLocusRequest = {
  set: Set;
  /**
   * The meaning of the numbers in `members` of a line. `sources`: the members of the set, as in a
   * Voronoi diagram. `segments`: first the points of the set, then the straight parts of its
   * curves, from corner to corner. A curve has a corner where it turns by more than 1e-6 radians.
   */
  members?: ("sources" | "segments");
  /**
   * Omits the lines whose angle, in radians, is smaller than this value at all of their points.
   * Lines whose angle is below 0.001 everywhere are always omitted.
   */
  min_angle?: number;
  /**
   * Greatest distance between a line and the polyline that approximates it, in the unit of the
   * mesh. The default is 1/2000 of the diagonal of the mesh's bounding box.
   */
  tolerance?: number;
};

export type CutLocusAnswer = {
  /** Ordered by their members. */
  lines: CutLocusLine[];
};

export type CutLocusLine = {
  /** The numbers of the members of both paths, ascending; they may be equal. */
  members: [number, number];
  closed: boolean;
  /** Length of the polyline. */
  length: number;
  /**
   * A polyline as in a path. Two shortest paths of equal length reach each of its points. A closed
   * polyline ends in its first point.
   */
  points?: (PathPoint | Vector)[];
};

export type VoronoiRequest = {
  set: Set;
  /**
   * Greatest distance between a bisector and the polyline that approximates it, in the unit of the
   * mesh. The default is 1/2000 of the diagonal of the mesh's bounding box.
   */
  tolerance?: number;
};

export type VoronoiAnswer = {
  /**
   * Number of the nearest member by vertex index; `null` for vertices without a path or without
   * faces.
   */
  labels: (number | null)[];
  /** Ordered by their members. */
  bisectors: Bisector[];
};

export type Bisector = {
  /** The numbers of both members, ascending. */
  members: [number, number];
  closed: boolean;
  /** Length of the polyline. */
  length: number;
  /**
   * A polyline as in a path. Each of its points is equally near to both members. A closed polyline
   * ends in its first point.
   */
  points?: (PathPoint | Vector)[];
};

export type PictureRequest = {
  layers: PictureLayer[];
  camera?: PictureCamera;
  /** Pixels; width times height is at most 8,294,400. */
  width?: number;
  height?: number;
  background?: ("white" | "dark" | "transparent");
  /**
   * Draws the scale of distances and the names of layers, unless width or height is less than 200
   * pixels.
   */
  legend?: boolean;
};

export type PictureCamera = {
  /**
   * `auto` is `iso`, unless another view shows more of the layers' lines and points, or of the
   * source.
   */
  view?: ("auto" | "front" | "back" | "left" | "right" | "top" | "bottom" | "iso");
  /** From the surface to the eye; replaces `view`. */
  direction?: Vector;
  /** Upward direction; the default is y. */
  up?: Vector;
  /** With 1 the figure shows the whole surface. */
  zoom?: number;
  /**
   * Position in the middle of a figure with a zoom above 1; by default the middle of the surface.
   */
  target?: Vector;
};

/**
 * A layer. The first required member names its kind. Subdivision surfaces have the layers
 * `surface`, `field`, `isolines`, `path`, `trace`, `points` and `control_net`; NURBS surfaces have
 * `surface`, `field`, `isolines`, `path`, `curve`, `curve_distance`, `point_curve_distance`,
 * `points`, `isoparametric` and `control_net`; meshes have all except `point_curve_distance`,
 * `isoparametric` and `control_net`.
 */
export type PictureLayer = (PictureSurfaceLayer | PictureFieldLayer | PictureIsolinesLayer | PicturePathLayer | PictureTraceLayer | PictureExpLayer | PictureSplineLayer | PictureCurveLayer | PictureCurveDistanceLayer | PictureVoronoiLayer | PictureCutLocusLayer | PictureCutLayer | PicturePointsLayer | PicturePointCurveDistanceLayer | PictureIsoparametricLayer | PictureControlNetLayer);

/** How the surface itself is drawn. */
export type PictureSurfaceLayer = {
  surface: PictureSurface;
  color?: PictureColor;
};

/**
 * Colours the surface by the distance from a set. On a mesh, any set is possible; on a smooth
 * surface, the set consists of places. On a mesh the distance is exact. On a smooth surface it is
 * the exact distance on the mesh that the figure draws. For a subdivision surface, this mesh is the
 * discretization of the usual level; for a NURBS surface, a tessellation with about 40,000
 * triangles. The vertices of the mesh lie on the surface. As the triangles get smaller, the
 * distance converges to the distance on the surface. The places become points of the mesh with the
 * same parameters.
 */
export type PictureFieldLayer = {
  field: (Set | PictureLimitPlacesRequest | PicturePlacesRequest);
  /** Points farther away have no colour. */
  max_distance?: number;
};

/** Places on a subdivision surface. */
export type PictureLimitPlacesRequest = {
  points: LimitPlace[];
};

/** Places on a NURBS surface. */
export type PicturePlacesRequest = {
  points: Place[];
};

/** Isolines of the distance that the layer `field` shows. */
export type PictureIsolinesLayer = {
  isolines: PictureIsolines;
  color?: PictureColor;
  width?: PictureWidth;
};

/** The shortest path of `POST …/path`. */
export type PicturePathLayer = {
  path: (PairRequest | LimitPairRequest | GeodesicRequest);
  /** Draws a ring at the start and a disc at the end. */
  ends?: boolean;
  color?: PictureColor;
  width?: PictureWidth;
  hidden?: PictureHidden;
  label?: PictureLabel;
};

/** The straightest geodesics of `POST …/trace`. */
export type PictureTraceLayer = {
  trace: (TraceRequest | LimitTraceRequest);
  color?: PictureColor;
  width?: PictureWidth;
  hidden?: PictureHidden;
  label?: PictureLabel;
};

/** The paths of `POST …/exp`. */
export type PictureExpLayer = {
  exp: ExpRequest;
  color?: PictureColor;
  width?: PictureWidth;
  hidden?: PictureHidden;
  label?: PictureLabel;
};

/** The curve of `POST …/spline`. */
export type PictureSplineLayer = {
  spline: SplineRequest;
  /**
   * Draws the control vectors: the geodesics between a point and the two control points beside it,
   * and the control points.
   */
  controls?: boolean;
  /**
   * Draws the tangent (red), the normal (blue) and the binormal (green) at the samples whose
   * numbers are multiples of this value; 0 draws none.
   */
  frames?: number;
  color?: PictureColor;
  width?: PictureWidth;
  hidden?: PictureHidden;
  label?: PictureLabel;
};

/** On a mesh, the curves of `POST …/curve`. On a NURBS surface, a curve in the domain. */
export type PictureCurveLayer = {
  curve: (CurveOperationRequest | DomainCurve);
  color?: PictureColor;
  width?: PictureWidth;
  hidden?: PictureHidden;
  label?: PictureLabel;
};

/** The path of `POST …/curve-distance`. */
export type PictureCurveDistanceLayer = {
  curve_distance: (CurveDistanceRequest | NurbsCurveDistanceRequest);
  color?: PictureColor;
  width?: PictureWidth;
  hidden?: PictureHidden;
  label?: PictureLabel;
};

/** The bisectors of `POST …/voronoi`. */
export type PictureVoronoiLayer = {
  voronoi: VoronoiRequest;
  color?: PictureColor;
  width?: PictureWidth;
  hidden?: PictureHidden;
  label?: PictureLabel;
};

/** The lines of `POST …/cut-locus`. */
export type PictureCutLocusLayer = {
  cut_locus: CutLocusRequest;
  color?: PictureColor;
  width?: PictureWidth;
  hidden?: PictureHidden;
  label?: PictureLabel;
};

/**
 * The pieces of `POST …/cut`, which replace the surface, and their boundaries as lines. The figure
 * stores no meshes, so `names` and `select_only` are refused. A figure with this layer has no
 * `field`. Other layers are drawn on the uncut surface: with `apart: 0` they lie on the pieces.
 */
export type PictureCutLayer = {
  cut: CutRequest;
  /**
   * The distance by which the pieces are moved, as a fraction of the diagonal of the mesh's
   * bounding box. The piece with the largest area stays. Every other piece moves in the direction
   * that it faces, which is the direction of the sum of its faces' area vectors. If this sum is
   * less than a tenth of the piece's area, as for a tube, the piece moves away from the middle of
   * the largest one.
   */
  apart?: number;
  color?: PictureColor;
  width?: PictureWidth;
  hidden?: PictureHidden;
  label?: PictureLabel;
};

/** Points as discs. */
export type PicturePointsLayer = {
  points: (Point | LimitPlace | Place)[];
  /**
   * Texts beside the points, in their order, at most as many as points. An empty text draws
   * nothing.
   */
  labels?: PictureLabel[];
  /** In the unit of `width`. */
  radius?: number;
  color?: PictureColor;
  hidden?: PictureHidden;
  label?: PictureLabel;
};

/** The path of `POST …/point-curve-distance`. Only for NURBS surfaces. */
export type PicturePointCurveDistanceLayer = {
  point_curve_distance: PointCurveRequest;
  color?: PictureColor;
  width?: PictureWidth;
  hidden?: PictureHidden;
  label?: PictureLabel;
};

/** Lines of constant u or v. Only for NURBS surfaces. */
export type PictureIsoparametricLayer = {
  isoparametric: PictureIsoparametric;
  color?: PictureColor;
  width?: PictureWidth;
  hidden?: PictureHidden;
  label?: PictureLabel;
};

/**
 * The control points of a NURBS or subdivision surface, and the lines between neighbours. On a
 * subdivision surface, these lines are the edges of the control mesh.
 */
export type PictureControlNetLayer = {
  control_net: PictureControlNet;
  color?: PictureColor;
  width?: PictureWidth;
  hidden?: PictureHidden;
  label?: PictureLabel;
};

export type PictureIsoparametric = {
  /**
   * Number of equal parts into which the lines of constant u divide the range of u; 0 draws no such
   * lines.
   */
  u?: number;
  /**
   * Number of equal parts into which the lines of constant v divide the range of v; 0 draws no such
   * lines.
   */
  v?: number;
};

export type PictureControlNet = {
  /** Draws the control points. */
  points?: boolean;
};

export type PictureSurface = {
  /** Draws the edges of triangles where they are not too dense. */
  edges?: boolean;
};

export type PictureIsolines = {
  /** Approximate number of isolines at round distances. */
  count?: number;
  /** Distances. */
  levels?: number[];
};

/** A colour in sRGB. */
export type PictureColor = string;

/**
 * Width of lines in units, by default 3 for one line and 1.6 for several. A unit is a pixel in a
 * figure of 800 x 600 and grows with the figure.
 */
export type PictureWidth = number;

/**
 * How to draw the parts that the surface hides. The default is `faint`; for the layer
 * `isoparametric` it is `none`.
 */
export type PictureHidden = ("faint" | "none" | "shown");

/** Printable ASCII. */
export type PictureLabel = string;

export type CutRequest = {
  curve: Curve;
  /** Keeps only the piece that contains this point. */
  inside?: Point;
  /** Returns lists of faces; stores no meshes. */
  select_only?: boolean;
  /** Names of the new meshes, one for each piece. */
  names?: Name[];
};

export type CutAnswer = {
  /** The cut increases the number of components. */
  separates: boolean;
  pieces: CutPiece[];
  /** Greatest distance by which the curve was moved. */
  largest_shift: number;
};

export type CutPiece = {
  name?: Name;
  vertices?: number;
  faces: number;
  area: number;
  /**
   * For each vertex of the piece the vertex of the parent, or `null` for a new vertex. Vertices of
   * the parent are first, in their order. Absent with `select_only`.
   */
  vertex_map?: (Index | null)[];
  /** For each face of the piece the face of the parent in which it lies, in ascending order. */
  face_map: Index[];
};

/**
 * A direction at a point: an angle, a vector of any length, or an object with either, as in
 * answers. If an object has both, the angle is used. In a face, a vector is projected
 * perpendicularly onto the face; at a vertex, along the vertex normal. A direction that points
 * across the boundary is rejected.
 */
export type DirectionRequest = (number | Vector | DirectionObject);

export type DirectionObject = {
  angle?: number;
  xyz?: Vector;
};

/** Either `directions` or `fan`. */
export type TraceRequest = {
  start: Point;
  directions?: DirectionRequest[];
  /**
   * Number of directions at equal angles around the point, starting at zero. At a boundary point,
   * they extend from one side of the boundary to the other.
   */
  fan?: number;
  length: number;
  vertex_rule?: ("bisect" | "limit_normal");
  boundary_rule?: ("stop" | "slide");
  /** Ends the line where it crosses or touches itself. */
  stop_at_self_intersection?: boolean;
  step_limit?: number;
};

/**
 * A path and its end. `end_direction` is the direction in which the path would continue; at the
 * boundary it points away from the surface.
 */
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

/**
 * `direction` and `length`, or `segments`, or a vector from an answer of `log`, unchanged. If a
 * vector has both, `exp` traces the segments, while `transport` and `combine` use direction and
 * length. The direction of a vector of length 0 may be `null`. The length `null` means that there
 * is no path. `reason` and `cut_locus` are ignored.
 */
export type VectorRequest = {
  direction?: (DirectionRequest | null);
  length?: (number | null);
  reason?: string;
  cut_locus?: boolean;
  /**
   * Segments in the order in which they are traced. After the first segment, a direction is an
   * angle.
   */
  segments?: Array<{
    direction: DirectionRequest;
    length: number;
  }>;
};

/** A vector. `direction` is `null` if the length is 0 or if there is no path. */
export type TangentVector = {
  direction: (Direction | null);
  length: (number | null);
  reason?: "no_path";
  /** Other paths are equally short and leave in other directions. */
  cut_locus?: true;
  segments?: Array<{
    direction: Direction;
    length: number;
  }>;
};

export type ExpRequest = {
  start: Point;
  /**
   * At most 10,000 vectors, with at most 10,000 segments in total. `null`, which `log` returns for
   * a vertex without faces, is a vector without a path.
   */
  vectors: (VectorRequest | null)[];
  /**
   * A factor for each vector. Each vector needs a direction and a length; `null`, and vectors
   * without a path, are rejected.
   */
  combine?: number[];
};

export type ExpAnswer = {
  start: PointAnswer;
  vectors: TangentVector[];
  /** `null` for a vector without a path. */
  points: (PointAnswer | null)[];
  /** `null` for a vector without a path. */
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
  /**
   * Each vector has a direction and a length, or one segment. For a vector without a path, the
   * result has no path either.
   */
  vectors: (VectorRequest | null)[];
  /** A factor for each vector. `null`, and vectors without a path, are rejected. */
  combine?: number[];
};

export type TransportAnswer = {
  from: PointAnswer;
  to: PointAnswer;
  distance: (number | null);
  reason?: "no_path";
  /** The vectors; `null` if there is no path. */
  vectors: (TangentVector[] | null);
};

export type MeanRequest = {
  points: Point[];
  /** A weight for each point, not all 0; equal by default. */
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
  /** Joins the last point to the first. The list does not repeat the first point. */
  closed?: boolean;
  /** 0 uniform, 0.5 centripetal, 1 chordal. */
  alpha?: number;
  /** With 1 the curve is a geodesic polyline. */
  tension?: number;
  tangent_rule?: ("symmetric" | "paper");
  end_rule?: ("natural" | "zero");
  /** `de_casteljau` needs `samples` or `at`, and no constant `speed`. */
  evaluation?: ("halving" | "de_casteljau");
  /**
   * A tangent for each point, per unit of the parameter; `null` selects the rule. The vectors of
   * `log` are accepted unchanged; their direction and length are used.
   */
  tangents?: ({
    direction: (DirectionRequest | null);
    length: number;
    reason?: string;
    cut_locus?: boolean;
    segments?: unknown[];
  } | null)[];
  /** Samples per segment, at most 100,000 in total. */
  samples?: number;
  /** Allowed only with `samples`. */
  speed?: ("parameter" | "constant");
  tolerance?: number;
  spacing?: number;
};

/** At most one of `samples`, `tolerance`, `spacing` and `at`. */
export type SplineRequest = {
  points: Point[];
  /** Joins the last point to the first. The list does not repeat the first point. */
  closed?: boolean;
  /** 0 uniform, 0.5 centripetal, 1 chordal. */
  alpha?: number;
  /** With 1 the curve is a geodesic polyline. */
  tension?: number;
  tangent_rule?: ("symmetric" | "paper");
  end_rule?: ("natural" | "zero");
  /** `de_casteljau` needs `samples` or `at`, and no constant `speed`. */
  evaluation?: ("halving" | "de_casteljau");
  /** A tangent for each point, per unit of the parameter; `null` selects the rule. */
  tangents?: ({
    direction: DirectionRequest;
    length: number;
  } | null)[];
  /** Samples per segment, at most 100,000 in total. */
  samples?: number;
  /** Allowed only with `samples`. */
  speed?: ("parameter" | "constant");
  tolerance?: number;
  spacing?: number;
  /** Parameters in ascending order, from 0 to the last of the answer's `parameters`. */
  at?: number[];
  frames?: boolean;
};

export type SplineAnswer = {
  path: Path;
  segments: Array<{
    control_points: [PointAnswer, PointAnswer, PointAnswer, PointAnswer];
    /** Distance between the ends of the segment. */
    distance: number;
    clipped: boolean;
    cut_locus: boolean;
  }>;
  /**
   * Parameters of the points; for a closed curve also that of the first point after a full round.
   */
  parameters: number[];
  /** One for each point. */
  joints: SplineJoint[];
  /** Present if requested. */
  frames?: SplineFrame[];
  /** The arc length between two samples, with `spacing` or `speed: constant`. */
  step?: number;
};

export type SplineFrame = {
  parameter: number;
  xyz: Vector;
  tangent: Vector;
  normal: Vector;
  binormal: Vector;
  speed: number;
};

export type SplineJoint = {
  tangent: TangentVector;
  /**
   * Angle in radians by which the curve turns at the point. Where its speed is 0 this is the angle
   * between the limits of its tangents. 0 at the ends of an open curve.
   */
  angle_jump: number;
  speed_jump: number;
};

export type CurveOperationRequest = {
  curve: Curve;
  operation: ("length" | "resample" | "shorten" | "closed-geodesic" | "offset");
  /** For `resample`. */
  count?: number;
  /** For `shorten`. By default the curve is shortened until it is a geodesic. */
  rounds?: number;
  /** For `shorten` with `rounds`. */
  pieces?: number;
  /** For `offset`. */
  distance?: number;
  /** For `offset`. */
  tolerance?: number;
};

/** The members depend on the operation. */
export type CurveOperationAnswer = {
  path?: Path;
  /** For `resample`. */
  points?: PointAnswer[];
  /** `turn`, `rounds` and `geodesic` are present for `shorten` and `closed-geodesic`. */
  turn?: number;
  rounds?: number;
  geodesic?: boolean;
  /** For `offset`. */
  paths?: Array<{
    closed: boolean;
    path: Path;
  }>;
};

export type SamplingRequest = {
  count: number;
  /** The first point; by default the lowest-numbered vertex that has faces. */
  start?: Point;
};

export type SamplingAnswer = {
  /** Points; [x, y, z] with `geometry=xyz`. */
  points?: (PointAnswer | Vector)[];
  /**
   * Entry i is the covering radius of points 0 to i: the greatest distance of a point of the
   * surface from the nearest of these points. This is the distance of point i + 1 from the points
   * before it. Entries never increase. An entry is `null` while a component has no point.
   */
  radii: (number | null)[];
};

export type Isoline = {
  level: number;
  lines: Array<{
    closed: boolean;
    /** Length of the exact line, not of the polyline. */
    length: number;
    /**
     * A polyline as in a path: the points where the line crosses edges, the points where arcs meet
     * inside faces, and more points between them as the tolerance requires. A closed polyline ends
     * in its first point. With `arcs` and without a tolerance, arc i leads from point i to point i
     * + 1.
     */
    points?: (PathPoint | Vector)[];
    arcs?: Arc[];
  }>;
};

/**
 * A circular arc in the plane of a face. Seen from outside, it runs counter-clockwise from the
 * angle `start`, in [0, 2 pi), to the angle `end`. Angle zero at the centre is the direction of the
 * first edge of the face, from its first to its second corner in the order of the file. Let x be
 * the unit vector of this edge, and y the unit vector in the plane of the face, 90 degrees to the
 * left of x. Then the points of the arc are centre + radius (cos(angle) x + sin(angle) y). Where
 * the source is a curve, `straight` is true, and the piece is a straight segment.
 */
export type Arc = ({
  face: number;
  /** The source, unfolded into the plane; usually outside the face. */
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
  wedges: Wedge[];
};

/**
 * Definition 1 of Liu, "Exact geodesic metric in 2-manifold triangle meshes using edge-based data
 * structures". Lengths along the edge are measured from its lower-numbered vertex.
 */
export type Wedge = {
  b0: number;
  b1: number;
  /** Distance from the pseudo-source to the start of the wedge. */
  d0: number;
  /** Distance from the pseudo-source to the end of the wedge. */
  d1: number;
  /** Distance from the set to the pseudo-source. */
  sigma: number;
  /** The pseudo-source lies to the left of the edge, seen from its lower vertex. */
  tau: boolean;
  /**
   * Present if the source is a segment of a curve, and the paths leave this segment at right
   * angles. Then the distance changes linearly from d0 to d1.
   */
  linear?: true;
  /** The pseudo-source, a vertex of the mesh or a member of the set. */
  source: {
    vertex?: Index;
    member?: Index;
  };
};

export type MeshJson = {
  vertices: Vector[];
  faces: Array<Index[]>;
};

/** The text that the client gave with `?description=` or PATCH. Absent if there is none. */
export type SurfaceDescription = string;

export type SurfaceChange = {
  /**
   * The new text, in UTF-8 without control characters; `null` or an empty text removes the
   * description.
   */
  description?: (string | null);
};

export type MeshList = {
  meshes: Mesh[];
  /** The `after` of the next page; `null` on the last page. */
  next: (string | null);
};

export type BoundaryLoop = {
  vertices: Count;
  length: number;
};

export type Mesh = {
  name: Name;
  /** SHA-256 of the uploaded bytes or, for a mesh that the daemon made, of its file. */
  sha256: string;
  /**
   * Number of vertices of the upload, including unreferenced vertices, plus the copies that
   * `repair` appended.
   */
  index_count: number;
  /** Number of vertices that have faces. */
  vertices: number;
  /** Number of triangles. */
  faces: number;
  edges: Count;
  components: Count;
  /**
   * Number of boundary loops. Absent if the mesh is not in memory and an old version of the daemon
   * stored it.
   */
  boundary_count?: number;
  /** The first boundary loops; `/v1/meshes/{name}/boundaries` lists all. */
  boundaries: BoundaryLoop[];
  euler_characteristic: number;
  /** Sum over the components. */
  genus: number;
  orientation: {
    /** Faces turned over for a consistent orientation. */
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
  /**
   * Nearly degenerate faces (height less than 1e-6 of the longest edge). These faces are valid;
   * faces without area are rejected.
   */
  degenerate_faces: number;
  /** Interior vertices with a total angle above 2 pi. */
  saddle_vertices: number;
  unreferenced_vertices: Count;
  repair: {
    /** Edges with more than two faces that were split. */
    edges_split: number;
    /** Number of vertices that were copied. */
    vertices_split: number;
    /** Number of indices that denote another vertex because of `weld`. */
    vertices_welded: number;
    /**
     * Number of indices that denote another vertex because an edge joined both vertices. The edge
     * had length zero, or belonged to a face without area and was shorter than 1e-6 of the longest
     * edge of this face.
     */
    vertices_merged: number;
    /** Unused face indices: an earlier face has the same vertices. */
    duplicate_faces: number;
    /**
     * Unused face indices: the face collapsed, or has no area and no single neighbour at its
     * longest edge.
     */
    degenerate_faces: number;
    /** Flipped longest edges of faces without area. */
    edges_flipped: number;
    /**
     * Number of faces with a repeated corner (a bridge joins the face to its hole) that were
     * divided into triangles.
     */
    faces_cut?: number;
    /**
     * Number of lines of the file that were wholly or partly skipped: faces with fewer than three
     * corners, extra values after a record in PLY text, unknown lines of a PLY header, corners of a
     * glTF primitive after its last whole triangle.
     */
    lines_skipped?: number;
    /**
     * Greatest distance by which welding or merging vertices, or flipping edges, may have moved a
     * point of the surface.
     */
    largest_shift: number;
    /** Number of all copies. They have the last indices below `index_count`. */
    vertices_copied: number;
    /** The first copies, each with its original vertex. */
    copies: IndexPair[];
    /** The first elements of each kind. */
    first: {
      /** The vertices of the edge. */
      edges_split?: IndexPair[];
      /** The vertex and the number of its copies. */
      vertices_split?: IndexPair[];
      /** The index and the vertex that it denotes. */
      vertices_welded?: IndexPair[];
      /** The index and the vertex that it denotes. */
      vertices_merged?: IndexPair[];
      /** The removed face and the remaining face. */
      duplicate_faces?: IndexPair[];
      /** The removed face. */
      degenerate_faces?: Index[];
      /** The face without area and its neighbour. */
      edges_flipped?: IndexPair[];
      /** The first index of the face and the repeated vertex. */
      faces_cut?: IndexPair[];
      /** The number of the line, which starts at 1. For binary files, the byte. */
      lines_skipped?: Index[];
    };
  };
  /** Present for a mesh that `derive` made or that was uploaded with edits. */
  derived_from?: {
    mesh?: Name;
    /**
     * Version of the original mesh at that time. For an upload with edits, `mesh` is absent, and
     * this is the ETag of its file without edits.
     */
    etag: string;
    /** Largest distance found between both surfaces. */
    largest_distance: number;
    /** As in a request to `derive`. */
    operations: Array<Record<string, unknown>>;
  };
  memory_bytes: Count;
  /** Number of cached fields. It changes without the ETag. */
  fields_cached: Count;
  created: string;
  /** ETag of the file and its options, without quotes. */
  etag: string;
  description?: SurfaceDescription;
};

/**
 * Parameters [u, v]. In a closed direction, a parameter may be any number; otherwise it lies in the
 * domain.
 */
export type Place = [number, number];

/** Knots in ascending order; knots may repeat. */
export type Knots = number[];

export type Interval = [number, number];

export type SubdivisionJson = (MeshJson | UsdMesh);

/** The members of USD's Mesh. */
export type UsdMesh = {
  points: Vector[];
  faceVertexCounts: Count[];
  faceVertexIndices: Index[];
  /** Vertices of chains of edges, chain by chain. */
  creaseIndices?: Index[];
  /** Number of vertices of each chain. */
  creaseLengths?: number[];
  /** One for each chain or one for each edge; 10 and above are infinitely sharp. */
  creaseSharpnesses?: number[];
  cornerIndices?: Index[];
  cornerSharpnesses?: number[];
  /** `none` only if there is no boundary. */
  interpolateBoundary?: ("edgeAndCorner" | "edgeOnly" | "none");
  subdivisionScheme?: ("catmullClark" | "loop");
};

export type Subdivision = {
  name: Name;
  /** SHA-256 of the uploaded bytes. */
  sha256: string;
  scheme: ("catmull_clark" | "loop");
  /** Vertices of the control mesh. `edges` and `faces` also count elements of the control mesh. */
  vertices: Count;
  edges: Count;
  faces: Count;
  /** Interior vertices of a valence other than 4 (Loop: 6). */
  extraordinary_vertices: Array<{
    valence: Count;
    count: Count;
  }>;
  /** Edges and vertices with a tag, except boundary edges. */
  crease_edges: Count;
  corner_vertices: Count;
  boundary_edges: Count;
  /** Number of boundary loops. */
  boundaries: Count;
  /** Least level of a discretization: 1 if there are polygons other than quads. */
  least_level: Count;
  /** Default level of queries. */
  usual_level: Count;
  memory_bytes: Count;
  created: string;
  /** ETag of the file and its options, without quotes. */
  etag: string;
  description?: SurfaceDescription;
};

export type SubdivisionList = {
  subdivisions: Subdivision[];
  /** The `after` of the next page; `null` on the last page. */
  next: (string | null);
};

/**
 * A place on the limit surface: a face of the control mesh, and (u, v) in it. u grows from the
 * first corner to the second, v from the first to the fourth (Loop: to the third, with u + v at
 * most 1). A polygon with n != 4 corners has n parts, one for each `corner`. There u grows from
 * this corner to the middle of the next edge, and v to the middle of the previous edge; (1,1) is
 * the middle of the face.
 */
export type LimitPlace = {
  face: Index;
  uv: [number, number];
  /** 0 by default. */
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
    /** Present if true. */
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

/** Either `directions` or `fan`. */
export type LimitTraceRequest = {
  start: LimitPlace;
  directions?: DirectionRequest[];
  /** Number of directions at equal angles around the place, starting at zero. */
  fan?: number;
  length: number;
  vertex_rule?: ("bisect" | "limit_normal");
  /** Traces on the limit surface itself. */
  smooth?: boolean;
  /** Ends the line where it crosses or touches itself. Not with `smooth`. */
  stop_at_self_intersection?: boolean;
  /**
   * Level of the discretization: each edge of the control mesh becomes 2^level edges. At least
   * `least_level`, by default `usual_level`; the description of the surface has both.
   */
  level?: number;
};

export type LimitTraceAnswer = {
  start: LimitPoint;
  /** Absent with `smooth`. */
  level?: Count;
  paths: Array<{
    length: number;
    points?: LimitPoints;
    end_direction: LimitDirection;
    end_reason: ("length" | "boundary" | "singular" | "self_intersection" | "step_limit");
  }>;
};

/**
 * A direction at a place, as an angle and as a vector. Angle zero is the first edge of the face
 * (du).
 */
export type LimitDirection = {
  /** `null` if the surface has no normal there. */
  angle: (number | null);
  xyz: Vector;
};

export type LimitPoints = (LimitPoint | Vector)[];

export type LevelRequest = {
  /**
   * Level of the discretization: each edge of the control mesh becomes 2^level edges. At least
   * `least_level`, by default `usual_level`; the description of the surface has both.
   */
  level?: number;
  /**
   * The queries that will use the level. - `traces`: `trace`. Only the vertices are built. -
   * `paths`: `distance`, `path`, `picture`, and `trace` with `stop_at_self_intersection`. A
   * complete mesh is built, which takes more time and memory. - `all`: both.
   */
  use?: ("all" | "traces" | "paths");
};

export type LevelAnswer = {
  level: Count;
  /** Memory of the discretizations that the request names. */
  bytes: Count;
};

export type LimitPairRequest = {
  from: LimitPlace;
  to: LimitPlace;
  /**
   * Level of the discretization: each edge of the control mesh becomes 2^level edges. At least
   * `least_level`, by default `usual_level`; the description of the surface has both.
   */
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

/** Either `mesh` or `format`. */
export type DeriveRequest = {
  operations: EditOperation[];
  mesh?: Name;
  /** Each component becomes a mesh, `mesh`-1 and so on. */
  split?: boolean;
  /** Format of the file. */
  format?: ("obj" | "ply" | "off" | "stl" | "glb" | "gltf");
};

export type DeriveAnswer = (Mesh | MeshParts);

/** The answer to a request with `split`. */
export type MeshParts = {
  /** By decreasing area. */
  meshes: Mesh[];
};

export type EditOperation = (SimplifyRequest | ComponentsRequest | FillRequest | SmoothRequest | SubdivideRequest);

/** `faces`, `max_distance` or both. */
export type SimplifyRequest = {
  operation: "simplify";
  /** Stops at this number of faces. */
  faces?: number;
  /** Greatest distance from the mesh that is simplified, in its unit. */
  max_distance?: number;
  /** Keeps all boundary edges. */
  keep_boundary?: boolean;
};

export type ComponentsRequest = {
  operation: "components";
  /** Number of components to keep. */
  keep?: number;
  /** Number of the largest components to leave out. */
  skip?: number;
};

export type PreviewProgress = {
  progress: number;
};

export type FillRequest = {
  operation: "fill";
  /** Longer boundary loops stay open. */
  max_edges?: number;
};

export type SmoothRequest = {
  operation: "smooth";
  iterations?: number;
  along?: ("tangent" | "normal" | "both");
  /**
   * Angle in degrees. If the normals of two faces differ by more than this angle, their common edge
   * does not move.
   */
  feature_angle?: number;
};

export type SubdivideRequest = {
  operation: "subdivide";
  scheme?: ("midpoint" | "loop" | "sqrt3");
  levels?: number;
};

export type VertexOrigins = {
  /**
   * The original mesh, and its version when the operations ran. For an upload with edits, only
   * `etag` is present.
   */
  mesh: {
    name?: Name;
    etag: string;
  };
  origins: Array<[number, number, number, number]>;
};

/** Either `level` or `tolerance`. */
export type DiscretizeRequest = {
  mesh: Name;
  /**
   * Level of the discretization: each edge of the control mesh becomes 2^level edges. At least
   * `least_level` of the description of the surface.
   */
  level?: number;
  /** Greatest distance of a triangle from the surface, in the unit of the surface. */
  tolerance?: number;
};

export type VertexPlaces = {
  /** The surface of which the mesh was made, and the version of this surface at that time. */
  subdivision: {
    name: Name;
    etag: string;
  };
  places: Array<[number, number, number, number]>;
};

export type NurbsFile = (NurbsSurface | {
  parametric: Shape;
  trims?: Trims;
});

export type NurbsSurface = {
  degreeU: number;
  degreeV: number;
  knotsU: SurfaceKnots;
  knotsV: SurfaceKnots;
  /**
   * Row i belongs to step i in the direction u, and item j of a row to step j in the direction v.
   * All items are [x, y, z], or all are [x, y, z, weight]. At most 4096 x 4096.
   */
  controlPoints: Array<Array<number[]>>;
  /** Positive numbers, one for each control point. All are 1 by default. */
  weights?: Array<number[]>;
  convention?: ("canonical" | "three" | "verb" | "rhino");
  trims?: Trims;
};

/**
 * Loops in the parameter plane. The surface is the part inside the outer loop and outside the
 * holes. Loops do not cross or touch, and a hole is not inside another hole. Without an outer loop
 * the surface extends to the borders of its domain and across the seams of closed directions; holes
 * then do not touch the borders or cross the seams. At most 256 loops and 4096 points.
 */
export type Trims = {
  outer?: TrimLoop;
  holes?: TrimLoop[];
};

/**
 * A simple closed curve, in either direction. Each curve ends where the next one begins, and the
 * last one ends where the first one begins.
 */
export type TrimLoop = TrimCurve[];

/** A polyline, or a rational B-spline; without knots a Bézier curve. */
export type TrimCurve = (TrimPolyline | TrimSpline);

export type TrimPolyline = {
  polyline: Array<[number, number]>;
};

export type TrimSpline = {
  degree: number;
  knots?: number[];
  /** All are [u, v], or all are [u, v, weight]. */
  controlPoints: Array<number[]>;
  weights?: number[];
};

/** Knots in ascending order; knots may repeat. */
export type SurfaceKnots = number[];

/** A surface of a known shape; exactly one member. */
export type Shape = {
  torus?: Torus;
  helicoid?: Helicoid;
  graph?: Graph;
  revolution?: Revolution;
};

/** ((major + minor cos v) cos u, (major + minor cos v) sin u, minor sin v), minor < major. */
export type Torus = {
  major: number;
  minor: number;
};

/** (v cos u, v sin u, pitch u). */
export type Helicoid = {
  /** Not 0. */
  pitch: number;
  u: Interval;
  v: Interval;
};

/**
 * (u, v, sum of coefficients[i][j] u^i v^j). Rows have equal length. The degrees are at most 16.
 */
export type Graph = {
  coefficients: Array<number[]>;
  u: Interval;
  v: Interval;
};

/**
 * (r(v) cos u, r(v) sin u, h(v)). Control points are [radius, height] of a B-spline or, with
 * weights, a NURBS curve. If the curve ends on the axis, this end is a pole.
 */
export type Revolution = {
  degree: number;
  knots: Knots;
  control_points: Interval[];
  weights?: number[];
};

export type NurbsAxis = {
  range: Interval;
  /** The two borders coincide. Any parameter is valid; the range is the period. */
  closed: boolean;
  /** Number of smooth pieces of the range. Derivatives may jump between pieces. */
  pieces: number;
  /** The border at the lower end of the range is one point. */
  pole_low: boolean;
  /** The border at the upper end of the range is one point. */
  pole_high: boolean;
};

export type Nurbs = {
  name: Name;
  /** SHA-256 of the uploaded bytes. */
  sha256: string;
  /** Shape of the file. Only the shape `nurbs` has the next four members. */
  shape: ("nurbs" | "torus" | "helicoid" | "graph" | "revolution");
  convention?: ("canonical" | "three" | "verb" | "rhino");
  degree?: [Count, Count];
  /** Number of control points in u and in v. */
  control_points?: [Count, Count];
  /** The weights are not all equal. */
  rational?: boolean;
  domain: {
    u: NurbsAxis;
    v: NurbsAxis;
  };
  /** Approximate size of the surface: the diagonal of the bounding box of sample points. */
  size: number;
  /** The surface supports shortest paths. */
  geodesics: boolean;
  /**
   * Faces of the tessellation that finds candidates for shortest paths; absent if there is none.
   */
  seeding_faces?: number;
  /** Why the surface does not support shortest paths. */
  reason?: string;
  /** Number of trimming loops; absent if the surface is not trimmed. */
  trimming_loops?: number;
  /** One of the loops is an outer loop; absent if the surface is not trimmed. */
  outer_loop?: boolean;
  memory_bytes: Count;
  created: string;
  /** ETag of the file and its options, without quotes. */
  etag: string;
  description?: SurfaceDescription;
};

export type NurbsList = {
  nurbs: Nurbs[];
  /** The `after` of the next page; `null` on the last page. */
  next: (string | null);
};

export type VertexParameters = {
  /** The surface of which the mesh was made, and the version of this surface at that time. */
  nurbs: {
    name: Name;
    etag: string;
  };
  /** Periods of u and of v; `null` if the direction is not closed. */
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

/** A point of space, as for `nearest` of meshes. */
export type FootPointRequest = {
  point: (string | SpacePoint);
};

export type FootAnswer = {
  uv: Place;
  xyz: Vector;
  distance: number;
};

/**
 * A curve in the domain: `polyline`, `bspline` or `iso`. The parameter of a polyline is i at its
 * corner i, the parameter of a B-spline is that of its knots, and the parameter of an iso line is
 * its variable coordinate. A curve whose ends are one point of the surface is always closed.
 */
export type DomainCurve = (DomainPolyline | DomainSpline | DomainLine);

export type DomainPolyline = {
  polyline: Place[];
  /** Joins the last corner to the first. */
  closed?: boolean;
};

export type DomainSpline = {
  bspline: DomainBspline;
  /** With `true` a B-spline that does not end at its start is rejected. */
  closed?: boolean;
};

export type DomainBspline = {
  degree: number;
  knots: Knots;
  control_points: Place[];
};

export type DomainLine = {
  /** The constant parameter. */
  iso: ("u" | "v");
  value: number;
  /** Range of the variable parameter; the whole domain by default. */
  range?: Interval;
};

/** Degree of the spline. */
export type SplineDegree = number;

/**
 * Number of control points of one spline across all knot lines; more than the degree. By default as
 * many as the tolerance needs.
 */
export type SplineControlPoints = number;

/** Relative error of the length. */
export type LengthTolerance = number;

/** Returns every local minimum that was found. */
export type AllMinima = boolean;

/**
 * With `all_minima`, the search covers the homotopy classes whose winding numbers in the closed
 * directions are at most this number. With 0, it covers only the classes of the candidates from the
 * tessellation.
 */
export type TurnLimit = number;

/**
 * Winding numbers [u, v] of a path. A path that begins at the parameters of its first end ends at
 * the parameters of its second end plus these numbers of periods. The numbers are 0 in directions
 * that are not closed.
 */
export type Turns = [number, number];

/** Number of points in the answer's `points`. */
export type PathSamples = number;

export type GeodesicRequest = {
  from: Place;
  to: Place;
  degree?: SplineDegree;
  control_points?: SplineControlPoints;
  tolerance?: LengthTolerance;
  all_minima?: AllMinima;
  turn_limit?: TurnLimit;
  turns?: Turns;
  initial?: DomainCurve;
  samples?: PathSamples;
};

export type PointCurveRequest = {
  point: Place;
  curve: DomainCurve;
  degree?: SplineDegree;
  control_points?: SplineControlPoints;
  tolerance?: LengthTolerance;
  all_minima?: AllMinima;
  turn_limit?: TurnLimit;
  turns?: Turns;
  initial?: DomainCurve;
  samples?: PathSamples;
};

export type NurbsCurveDistanceRequest = {
  a: DomainCurve;
  b: DomainCurve;
  degree?: SplineDegree;
  control_points?: SplineControlPoints;
  tolerance?: LengthTolerance;
  all_minima?: AllMinima;
  turn_limit?: TurnLimit;
  turns?: Turns;
  initial?: DomainCurve;
  samples?: PathSamples;
};

export type GeodesicEnd = {
  /** Parameter of the curve. */
  parameter?: number;
  uv: Place;
  xyz: Vector;
  /** Angle between path and curve; `null` if the length of the path is 0. */
  angle?: (number | null);
};

export type GeodesicAnswer = {
  length: number;
  /** Absent if the length is 0. */
  degree?: number;
  /**
   * From 0 to the number of pieces. Where two pieces meet, the multiplicity of the knot is the
   * degree; at a pole it is the degree plus 1.
   */
  knots: number[];
  control_points: Place[];
  /** Points at equally spaced parameters of the spline, from its start to its end. */
  points?: (Vector | {
    uv: Place;
    xyz: Vector;
  })[];
  /**
   * `from` and `to` for `path`, `curve` for `point-curve-distance`, `a` and `b` for
   * `curve-distance`.
   */
  ends: {
    from?: GeodesicEnd;
    to?: GeodesicEnd;
    curve?: GeodesicEnd;
    a?: GeodesicEnd;
    b?: GeodesicEnd;
  };
  /** Relative norm of the gradient of the length. */
  residual: number;
  /** Estimated error of the length, in the same unit. */
  error_estimate: number;
  /** Integral of the squared geodesic curvature along the path: 0 for an exact geodesic. */
  geodesic_curvature: number;
  /** Unevenness of the speed: (2 E - L^2) / L^2 with the energy E. */
  speed_defect: number;
  iterations: Count;
  /** The error of the length is at most the tolerance. */
  converged: boolean;
  /** The path is proved to be a local minimum. */
  is_minimum: boolean;
  boundary_contact: boolean;
  warnings: ("not_converged" | "boundary_contact" | "curve_corner" | "through_pole" | "not_minimal" | "family")[];
  turns: Turns;
  /**
   * Present with `all_minima`: the largest winding number of the classes that were searched. 0 if
   * no direction is closed.
   */
  turn_limit?: number;
  /**
   * Present with `all_minima`: the local minima in the order of their lengths. Each has the members
   * of this answer.
   */
  minima?: GeodesicAnswer[];
};

/** Either `tolerance` or `resolution`. */
export type TessellateRequest = {
  mesh: Name;
  /** Approximate greatest distance of an edge from the surface, in the unit of the surface. */
  tolerance?: number;
  /** Number of parts in u and in v. */
  resolution?: [number, number];
};

export type Service = {
  version: string;
  limits: {
    max_body_bytes: Count;
    max_faces: Count;
    timeout_ms: Count;
    memory_budget_bytes: Count;
    /** Greatest size of an answer that is not a stream. */
    max_answer_bytes: Count;
    workers: Count;
  };
  capabilities: {
    formats: string[];
    queries: string[];
  };
};

export type Health = {
  /**
   * read_only: a write to the disk failed. Reads work, and changes return 507. degraded: the
   * database of `--store` does not respond. Meshes in memory can be queried, and other requests
   * return 503.
   */
  status: ("ok" | "starting" | "draining" | "read_only" | "degraded");
  /** Why the store is read-only or unreachable. */
  reason?: string;
};

export type Job = {
  id: JobId;
  /** Only `done` and `failed` jobs have an answer. */
  state: ("queued" | "running" | "done" | "failed" | "cancelled");
  /**
   * Fraction of the work that is done, such as the reached faces or the finished rows. It never
   * decreases. It stays constant while the job waits for work that another job started.
   */
  progress: number;
  created: string;
  /** Method and path of the request. */
  request: string;
  response?: JobResponse;
  /**
   * JSON answer of the operation. For other media types, a link to the answer. Absent in lists and
   * events.
   */
  result?: unknown;
  /** Why the operation failed. Absent in lists. */
  problem?: Problem;
};

/** Status and headers of the answer. */
export type JobResponse = {
  status: number;
  media_type: (string | null);
  bytes: Count;
  headers: Record<string, string>;
};

export type JobList = {
  jobs: Job[];
  /** The `after` of the next page; `null` on the last page. */
  next: (string | null);
};

/** A problem as defined by RFC 9457. */
export type Problem = {
  type: string;
  title: string;
  status: number;
  /** One sentence that says how to correct the request. */
  detail: string;
  code: ("invalid_request" | "unauthorized" | "forbidden" | "not_found" | "method_not_allowed" | "not_acceptable" | "conflict" | "field_evicted" | "length_required" | "precondition_failed" | "too_large" | "unsupported_media_type" | "invalid_mesh" | "point_not_on_surface" | "rate_limited" | "internal" | "overloaded" | "draining" | "store_unavailable" | "deadline_exceeded" | "insufficient_memory" | "insufficient_storage");
  /** JSON pointer into the body. */
  pointer?: string;
  /** Name of the query parameter. */
  parameter?: string;
  /** Why a mesh was rejected. */
  reason?: string;
  /** The configured maximum that was exceeded. */
  limit?: number;
  /** The first offending elements. */
  elements?: Array<{
    vertex?: Count;
    edge?: Edge;
    face?: Count;
    line?: Count;
    byte?: Count;
  }>;
};

/** The queries of `/v1/meshes/{name}` by name: request and answer. */
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
  /** Get the distances of many pairs of points */
  "pairs": {
    body: PairsRequest;
    answer: PairsAnswer;
  };
  /** Locate many points on the surface */
  "nearest-points": {
    body: NearestPointsRequest;
    answer: NearestPointsAnswer;
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
  /** Get the cut locus of a point or the medial axis of a curve */
  "cut-locus": {
    body: CutLocusRequest;
    answer: CutLocusAnswer;
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
  /** Draw a figure of the mesh */
  "picture": {
    body: PictureRequest;
    answer: unknown;
  };
  /** Cut a mesh along a curve into new meshes */
  "cut": {
    body: CutRequest;
    answer: CutAnswer;
  };
  /** Make a new mesh by edits */
  "derive": {
    body: DeriveRequest;
    answer: DeriveAnswer;
  };
}

/** The queries of `/v1/subdivisions/{name}` by name: request and answer. */
export interface SubdivisionQueries {
  /** Get position, derivatives, normal and curvatures of the limit surface */
  "evaluate": {
    body: LimitEvaluateRequest;
    answer: LimitEvaluateAnswer;
  };
  /** Get the point of the limit surface nearest to a point in space */
  "nearest": {
    body: (SpacePoint | FootPointRequest);
    answer: LimitFootAnswer;
  };
  /** Trace geodesics from a place */
  "trace": {
    body: LimitTraceRequest;
    answer: LimitTraceAnswer;
  };
  /** Build a level of the surface in advance */
  "levels": {
    body: LevelRequest;
    answer: LevelAnswer;
  };
  /** Get the geodesic distance between two places */
  "distance": {
    body: LimitPairRequest;
    answer: LimitPairAnswer;
  };
  /** Get the shortest path between two places */
  "path": {
    body: LimitPairRequest;
    answer: LimitPairAnswer;
  };
  /** Draw a figure of the surface */
  "picture": {
    body: PictureRequest;
    answer: unknown;
  };
  /** Store the surface as a triangle mesh */
  "tessellate": {
    body: DiscretizeRequest;
    answer: Mesh;
  };
  /** Store the surface as a triangle mesh */
  "discretize": {
    body: DiscretizeRequest;
    answer: Mesh;
  };
}

/** The queries of `/v1/nurbs/{name}` by name: request and answer. */
export interface NurbsQueries {
  /** Get position, derivatives, normal and curvatures at parameters */
  "evaluate": {
    body: EvaluateRequest;
    answer: EvaluateAnswer;
  };
  /** Get the point of the surface nearest to a point in space */
  "nearest": {
    body: (SpacePoint | FootPointRequest);
    answer: FootAnswer;
  };
  /** Get the shortest path between two points of the surface */
  "path": {
    body: GeodesicRequest;
    answer: GeodesicAnswer;
  };
  /** Get the shortest path between two points of the surface */
  "geodesic": {
    body: GeodesicRequest;
    answer: GeodesicAnswer;
  };
  /** Get the shortest path from a point to a curve on the surface */
  "point-curve-distance": {
    body: PointCurveRequest;
    answer: GeodesicAnswer;
  };
  /** Get the shortest path between two curves on the surface */
  "curve-distance": {
    body: NurbsCurveDistanceRequest;
    answer: GeodesicAnswer;
  };
  /** Draw a figure of the surface */
  "picture": {
    body: PictureRequest;
    answer: unknown;
  };
  /** Store the surface as a triangle mesh */
  "tessellate": {
    body: TessellateRequest;
    answer: Mesh;
  };
}

