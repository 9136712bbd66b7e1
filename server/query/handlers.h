/* Handlers: one function an operation of proto/openapi.yaml; the generated route table points to
 * them. Each is called by an HTTP thread with a whole request, and ends with a reply or with
 * server_exchange_defer (exchange.h). */
#ifndef SERVER_QUERY_HANDLERS_H
#define SERVER_QUERY_HANDLERS_H

#include "server/http/exchange.h"

/* service.c */
void server_handle_get_viewer(struct server_exchange *exchange);
void server_handle_get_openapi(struct server_exchange *exchange);
void server_handle_get_livez(struct server_exchange *exchange);
void server_handle_get_readyz(struct server_exchange *exchange);
void server_handle_get_metrics(struct server_exchange *exchange);
void server_handle_get_service(struct server_exchange *exchange);

/* surfaces.c, of any kind */
void server_handle_create_surface(struct server_exchange *exchange);
void server_handle_put_surface(struct server_exchange *exchange);
void server_handle_list_surfaces(struct server_exchange *exchange);
void server_handle_get_surface(struct server_exchange *exchange);
void server_handle_delete_surface(struct server_exchange *exchange);

/* meshes.c */
void server_handle_get_mesh_content(struct server_exchange *exchange);
void server_handle_list_boundaries(struct server_exchange *exchange);

/* pair.c */
void server_handle_distance(struct server_exchange *exchange);
void server_handle_path(struct server_exchange *exchange);

/* nearest.c */
void server_handle_nearest(struct server_exchange *exchange);

/* matrix.c */
void server_handle_matrix(struct server_exchange *exchange);

/* batch_stream.c */
void server_handle_batch(struct server_exchange *exchange);

/* sets.c */
void server_handle_distance_to_set(struct server_exchange *exchange);

/* curve_distance.c */
void server_handle_curve_distance(struct server_exchange *exchange);

/* fields.c */
void server_handle_create_field(struct server_exchange *exchange);
void server_handle_list_fields(struct server_exchange *exchange);
void server_handle_get_field(struct server_exchange *exchange);
void server_handle_delete_field(struct server_exchange *exchange);

/* field_values.c */
void server_handle_get_field_values(struct server_exchange *exchange);
void server_handle_evaluate_field(struct server_exchange *exchange);
void server_handle_get_field_wedges(struct server_exchange *exchange);

/* isolines.c */
void server_handle_isolines(struct server_exchange *exchange);

/* voronoi.c */
void server_handle_voronoi(struct server_exchange *exchange);

/* sampling.c */
void server_handle_farthest_points(struct server_exchange *exchange);

/* evaluate.c, nurbs_geodesic.c, tessellate.c */
void server_handle_nurbs_evaluate(struct server_exchange *exchange);
void server_handle_nurbs_nearest(struct server_exchange *exchange);
void server_handle_nurbs_geodesic(struct server_exchange *exchange);
void server_handle_nurbs_point_curve_distance(struct server_exchange *exchange);
void server_handle_nurbs_curve_distance(struct server_exchange *exchange);
void server_handle_nurbs_tessellate(struct server_exchange *exchange);

/* tessellate.c */
void server_handle_get_mesh_parameters(struct server_exchange *exchange);
void server_handle_get_mesh_places(struct server_exchange *exchange);

/* evaluate.c, subdivision_paths.c, tessellate.c */
void server_handle_subdivision_evaluate(struct server_exchange *exchange);
void server_handle_subdivision_nearest(struct server_exchange *exchange);
void server_handle_subdivision_trace(struct server_exchange *exchange);
void server_handle_subdivision_distance(struct server_exchange *exchange);
void server_handle_subdivision_path(struct server_exchange *exchange);
void server_handle_subdivision_discretize(struct server_exchange *exchange);

/* picture.c */
void server_handle_picture_png(struct server_exchange *exchange);
void server_handle_picture_svg(struct server_exchange *exchange);

/* cut.c */
void server_handle_cut(struct server_exchange *exchange);

/* trace.c, exp.c, log.c, transport.c, mean.c */
void server_handle_trace(struct server_exchange *exchange);
void server_handle_exp(struct server_exchange *exchange);
void server_handle_log(struct server_exchange *exchange);
void server_handle_transport(struct server_exchange *exchange);
void server_handle_mean(struct server_exchange *exchange);

/* spline.c */
void server_handle_spline(struct server_exchange *exchange);

/* curve.c */
void server_handle_curve(struct server_exchange *exchange);

/* jobs.c */
void server_handle_list_jobs(struct server_exchange *exchange);
void server_handle_get_job(struct server_exchange *exchange);
void server_handle_delete_job(struct server_exchange *exchange);
void server_handle_get_job_result(struct server_exchange *exchange);
void server_handle_get_job_events(struct server_exchange *exchange);

/* batches.c */
void server_handle_create_batch(struct server_exchange *exchange);
void server_handle_list_batches(struct server_exchange *exchange);
void server_handle_get_batch(struct server_exchange *exchange);
void server_handle_delete_batch(struct server_exchange *exchange);
void server_handle_get_batch_results(struct server_exchange *exchange);

/* jobs.c: any operation that takes Prefer: respond-async, asked for with it. Called like the
 * others. */
void server_handle_async(struct server_exchange *exchange);

#endif
