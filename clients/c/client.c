#include "internal.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define DEFAULT_URL  "http://127.0.0.1:8080"
#define UNIX         "unix:"
#define PATH_MOST    1024
#define RETRIES      5
#define TIMEOUT_S    120
#define WAIT_SECONDS 30 /* the longest wait of one request for a job or batch */
/* pause before the first retry; the pause doubles with each further retry */
#define BACKOFF_MS   100
#define BACKOFF_MOST 10000
/* a refusal with a longer Retry-After is returned at once */
#define RETRY_AFTER_MOST_S 120

/* --- life ------------------------------------------------------------------------------------- */

static char *join(const char *a, const char *b, const char *c)
{
    size_t size = strlen(a) + strlen(b) + strlen(c) + 1;
    char *text = malloc(size);
    if (text) snprintf(text, size, "%s%s%s", a, b, c);
    return text;
}

static int is_loopback(const char *url)
{
    static const char *const names[] = {"localhost", "[::1]", "127."};
    const char *scheme = strstr(url, "://"), *host = scheme ? scheme + 3 : url;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        size_t size = strlen(names[i]);
        const char *rest = host + size;
        if (strncmp(host, names[i], size) != 0) continue;
        if (i == 2) rest += strspn(rest, "0123456789.");
        if (*rest == '\0' || *rest == ':' || *rest == '/') return 1;
    }
    return 0;
}

static int set_address(struct gdc_client *client, const char *url)
{
    int is_unix = strncmp(url, UNIX, strlen(UNIX)) == 0;
    client->url = join(is_unix ? "http://localhost" : url, "", "");
    if (is_unix) client->socket_path = join(url + strlen(UNIX), "", "");
    if (client->url && *client->url && client->url[strlen(client->url) - 1] == '/')
        client->url[strlen(client->url) - 1] = '\0';
    client->is_near = is_unix || (client->url && is_loopback(client->url));
    return client->url && (!is_unix || client->socket_path);
}

/* Returns the header with the key, up to the first blank or control character: a key that is read
 * from a file often ends with a newline, which would end the header. */
static char *authorization_of(const char *key)
{
    char *line = join("Authorization: Bearer ", key, "");
    char *end = line ? line + strlen(line) - strlen(key) : NULL;
    while (end && (unsigned char)*end > ' ') end++;
    if (end) *end = '\0';
    return line;
}

struct gdc_client *gdc_client_create(const char *url, const char *key)
{
    struct gdc_client *client = calloc(1, sizeof *client);
    if (!client) return NULL;
    if (!url) url = getenv("GEODESICD_URL");
    if (!key) key = getenv("GEODESICD_KEY");
    client->retries = RETRIES;
    client->timeout_s = TIMEOUT_S;
    client->curl = curl_easy_init();
    if (key && *key) client->authorization = authorization_of(key);
    if (client->curl && set_address(client, url && *url ? url : DEFAULT_URL) &&
        (!key || !*key || client->authorization))
        return client;
    gdc_client_destroy(client);
    return NULL;
}

void gdc_client_destroy(struct gdc_client *client)
{
    if (!client) return;
    curl_easy_cleanup(client->curl);
    free(client->url);
    free(client->socket_path);
    free(client->authorization);
    free(client);
}

void gdc_client_set_retries(struct gdc_client *client, unsigned retries)
{
    client->retries = retries;
}

void gdc_client_set_timeout(struct gdc_client *client, long seconds)
{
    client->timeout_s = seconds;
}

void gdc_client_set_progress(struct gdc_client *client, gdc_progress progress, void *user)
{
    client->progress = progress;
    client->user = user;
}

/* --- problems --------------------------------------------------------------------------------- */

enum gdc_status gdc__fail(struct gdc_problem *problem, enum gdc_status status, const char *format,
                          ...)
{
    if (!problem) return status;
    va_list arguments;
    va_start(arguments, format);
    *problem = (struct gdc_problem){0};
    vsnprintf(problem->detail, sizeof problem->detail, format, arguments);
    va_end(arguments);
    return status;
}

static void copy_member(char *out, size_t size, const json_t *object, const char *name)
{
    const char *text = json_string_value(json_object_get(object, name));
    snprintf(out, size, "%s", text ? text : "");
}

/* Fills `problem` from an answer with a status of 400 or more. */
static enum gdc_status read_problem(const struct gdc_answer *answer, struct gdc_problem *problem)
{
    gdc__fail(problem, GDC_PROBLEM, "the answer has the status %d", answer->status);
    if (!problem) return GDC_PROBLEM;
    json_t *json = json_loadb(answer->body, answer->size, 0, NULL);
    problem->status = answer->status;
    copy_member(problem->code, sizeof problem->code, json, "code");
    copy_member(problem->pointer, sizeof problem->pointer, json, "pointer");
    if (json_is_string(json_object_get(json, "detail")))
        copy_member(problem->detail, sizeof problem->detail, json, "detail");
    json_decref(json);
    return GDC_PROBLEM;
}

/* --- answers ---------------------------------------------------------------------------------- */

enum gdc_status gdc__read_json(struct gdc_answer *answer, json_t **json,
                               struct gdc_problem *problem)
{
    json_t *read = json_loadb(answer->body, answer->size, JSON_DECODE_ANY, NULL);
    free(answer->body);
    if (!read) return gdc__fail(problem, GDC_BAD_ANSWER, "the daemon's answer is not JSON");
    *json = read;
    return GDC_OK;
}

enum gdc_status gdc__turn(struct gdc_client *client, const char *path, const char *parameter,
                          struct gdc_page *page, struct gdc_problem *problem)
{
    char whole[PATH_MOST];
    struct gdc_answer answer;
    char *next = curl_easy_escape(client->curl, page->next, 0);
    snprintf(whole, sizeof whole, "%s%s%s%s", path, *page->next ? parameter : "",
             *page->next ? "=" : "", next ? next : "");
    curl_free(next);
    enum gdc_status status =
        gdc_call(client, &(struct gdc_request){.method = "GET", .path = whole}, &answer, problem);
    if (status) return status;
    json_t *json = json_loadb(answer.body, answer.size, 0, NULL);
    free(page->json);
    page->json = answer.body;
    copy_member(page->next, sizeof page->next, json, "next");
    json_decref(json);
    return GDC_OK;
}

void gdc_free(void *memory)
{
    free(memory);
}

/* --- one exchange ----------------------------------------------------------------------------- */

/* A CURLOPT_WRITEFUNCTION: appends the bytes to the answer. Returning 0 ends the transfer. */
static size_t take(char *bytes, size_t one, size_t count, void *user)
{
    struct gdc_answer *answer = user;
    size_t size = one * count;
    char *body = realloc(answer->body, answer->size + size + 1);
    if (!body) return 0;
    memcpy(body + answer->size, bytes, size);
    answer->body = body;
    answer->size += size;
    body[answer->size] = '\0';
    return size;
}

/* Appends a copy of `line` to the list and frees `line`. Returns NULL after freeing the list if
 * memory is short. */
static struct curl_slist *with(struct curl_slist *list, char *line)
{
    struct curl_slist *longer = line ? curl_slist_append(list, line) : NULL;
    free(line);
    if (!longer) curl_slist_free_all(list);
    return longer;
}

static struct curl_slist *headers_of(const struct gdc_client *client,
                                     const struct gdc_request *request, int is_job)
{
    const char *json = "application/json";
    struct curl_slist *list =
        with(NULL, join("Accept: ", request->accept ? request->accept : json, ""));
    /* without this header, libcurl would wait for 100 Continue, which costs a round trip */
    if (list) list = with(list, join("Expect:", "", ""));
    if (list && request->body)
        list = with(
            list, join("Content-Type: ", request->content_type ? request->content_type : json, ""));
    if (list && client->authorization) list = with(list, join(client->authorization, "", ""));
    return list && is_job ? with(list, join("Prefer: ", "respond-async", "")) : list;
}

static void set_options(struct gdc_client *client, const struct gdc_request *request,
                        const char *url, struct curl_slist *headers, struct gdc_answer *answer)
{
    CURL *curl = client->curl;
    curl_easy_reset(curl); /* resets the options but keeps the connection open */
    curl_easy_setopt(curl, CURLOPT_URL, url);
    curl_easy_setopt(curl, CURLOPT_HTTPHEADER, headers);
    if (!client->is_near) curl_easy_setopt(curl, CURLOPT_ACCEPT_ENCODING, "gzip");
    curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT, client->timeout_s);
    curl_easy_setopt(curl, CURLOPT_LOW_SPEED_LIMIT, 1L);
    curl_easy_setopt(curl, CURLOPT_LOW_SPEED_TIME, client->timeout_s);
    curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, take);
    curl_easy_setopt(curl, CURLOPT_WRITEDATA, answer);
    if (client->socket_path) curl_easy_setopt(curl, CURLOPT_UNIX_SOCKET_PATH, client->socket_path);
    if (request->body) {
        curl_easy_setopt(curl, CURLOPT_POSTFIELDSIZE_LARGE, (curl_off_t)request->body_size);
        curl_easy_setopt(curl, CURLOPT_POSTFIELDS, request->body);
    }
    if (request->once) /* libcurl itself repeats a request that fails on a reused connection */
        curl_easy_setopt(curl, CURLOPT_FRESH_CONNECT, 1L);
    if (strcmp(request->method, "HEAD") == 0) curl_easy_setopt(curl, CURLOPT_NOBODY, 1L);
    curl_easy_setopt(curl, CURLOPT_CUSTOMREQUEST, request->method);
}

static CURLcode send_once(struct gdc_client *client, const struct gdc_request *request, int is_job,
                          struct gdc_answer *answer)
{
    struct curl_slist *headers = headers_of(client, request, is_job);
    char *url = join(client->url, request->path, "");
    CURLcode code = CURLE_OUT_OF_MEMORY;
    *answer = (struct gdc_answer){.body = calloc(1, 1)};
    if (headers && url && answer->body) {
        long status = 0;
        set_options(client, request, url, headers, answer);
        code = curl_easy_perform(client->curl);
        curl_easy_getinfo(client->curl, CURLINFO_RESPONSE_CODE, &status);
        answer->status = (int)status;
    }
    free(url);
    curl_slist_free_all(headers);
    return code;
}

/* --- with retries ----------------------------------------------------------------------------- */

/* Returns the seconds of the last answer's Retry-After; 0 without this header. */
static curl_off_t retry_after(struct gdc_client *client)
{
    curl_off_t seconds = 0;
    return curl_easy_getinfo(client->curl, CURLINFO_RETRY_AFTER, &seconds) == CURLE_OK ? seconds
                                                                                       : 0;
}

static void wait_before(struct gdc_client *client, unsigned attempt, int is_answer)
{
    curl_off_t told_s = is_answer ? retry_after(client) : 0;
    long ms = attempt < 7 ? BACKOFF_MS << attempt : BACKOFF_MOST;
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now); /* adds jitter, so that clients retry at different times */
    ms = ms / 2 + now.tv_nsec / 1000 % ms;
    if (told_s > 0) ms = 1000 * (long)told_s;
    nanosleep(&(struct timespec){ms / 1000, ms % 1000 * 1000000}, NULL);
}

static int is_worth_another(struct gdc_client *client, const struct gdc_request *request,
                            CURLcode code, const struct gdc_answer *answer)
{
    if (code == CURLE_OK)
        return (answer->status == 429 || answer->status == 503) &&
               retry_after(client) <= RETRY_AFTER_MOST_S &&
               (!request->once || retry_after(client) > 0);
    if (request->once) return code == CURLE_COULDNT_CONNECT;
    return code == CURLE_COULDNT_CONNECT || code == CURLE_GOT_NOTHING || code == CURLE_SEND_ERROR ||
           code == CURLE_RECV_ERROR || code == CURLE_PARTIAL_FILE;
}

static enum gdc_status judge(const struct gdc_client *client, CURLcode code,
                             struct gdc_answer *answer, struct gdc_problem *problem)
{
    if (code == CURLE_OK && answer->status >= 200 && answer->status < 300) return GDC_OK;
    enum gdc_status status = GDC_PROBLEM;
    if (code == CURLE_OUT_OF_MEMORY || code == CURLE_WRITE_ERROR)
        status = gdc__fail(problem, GDC_NO_MEMORY, "the system is out of memory");
    else if (code != CURLE_OK)
        status = gdc__fail(problem, GDC_NO_CONNECTION, "no answer from %s: %s",
                           client->socket_path ? client->socket_path : client->url,
                           curl_easy_strerror(code));
    else if (answer->status < 400)
        status = gdc__fail(problem, GDC_BAD_ANSWER,
                           "the answer has the status %d: another program answers at %s",
                           answer->status, client->socket_path ? client->socket_path : client->url);
    else
        read_problem(answer, problem);
    free(answer->body);
    return status;
}

int gdc__wait_seconds(const struct gdc_client *client)
{
    long most = client->timeout_s > 0 ? client->timeout_s / 2 : WAIT_SECONDS;
    if (most < 1) most = 1; /* without a wait, loops over answers would not pause */
    return most < WAIT_SECONDS ? (int)most : WAIT_SECONDS;
}

enum gdc_status gdc__exchange(struct gdc_client *client, const struct gdc_request *request,
                              int is_job, struct gdc_answer *answer, struct gdc_problem *problem)
{
    struct gdc_answer received;
    CURLcode code = send_once(client, request, is_job, &received);
    for (unsigned attempt = 0;
         attempt < client->retries && is_worth_another(client, request, code, &received);
         attempt++) {
        wait_before(client, attempt, code == CURLE_OK);
        free(received.body);
        code = send_once(client, request, is_job, &received);
    }
    enum gdc_status status = judge(client, code, &received, problem);
    if (!status) *answer = received;
    return status;
}

enum gdc_status gdc_call(struct gdc_client *client, const struct gdc_request *request,
                         struct gdc_answer *answer, struct gdc_problem *problem)
{
    int is_job = client->progress &&
                 (strcmp(request->method, "POST") == 0 || strcmp(request->method, "PUT") == 0);
    struct gdc_answer accepted;
    enum gdc_status status = gdc__exchange(client, request, is_job, &accepted, problem);
    if (status) return status;
    if (is_job && accepted.status == 202) return gdc__await_job(client, &accepted, answer, problem);
    *answer = accepted;
    return GDC_OK;
}
