/* See deprecation.h. */
#include "server/exchange/deprecation.h"

#include <string.h>

#include "server/exchange/exchange.h"

static uint32_t count_parameter(const struct server_exchange *exchange, const char *name)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < exchange->parameter_count; i++)
        count += strcmp(exchange->parameters[i].name, name) == 0;
    return count;
}

static void rename_parameter(struct server_exchange *exchange,
                             const struct proto_deprecation *deprecation)
{
    for (uint32_t i = 0; i < exchange->parameter_count; i++) {
        if (strcmp(exchange->parameters[i].name, deprecation->name) == 0)
            exchange->parameters[i].name = deprecation->replacement;
    }
}

static bool parameter_apply(struct server_exchange *exchange,
                            const struct proto_deprecation *deprecation,
                            struct proto_problem *problem)
{
    uint32_t count = count_parameter(exchange, deprecation->name);
    if (count == 0) return true;
    exchange->deprecation = deprecation;
    if (count > 1)
        return proto_problem_refuse(problem, deprecation->name,
                                    "the parameter \"%s\" stands more than once",
                                    deprecation->name);
    if (count_parameter(exchange, deprecation->replacement))
        return proto_problem_refuse(
            problem, deprecation->name, "\"%s\" is the former name of \"%s\"; send only \"%s\"",
            deprecation->name, deprecation->replacement, deprecation->replacement);
    rename_parameter(exchange, deprecation);
    return true;
}

bool server_deprecation_apply(struct server_exchange *exchange, struct proto_problem *problem)
{
    const struct proto_route *route = exchange->match.route;
    const struct proto_deprecation *each = route->deprecated_parameters;
    exchange->deprecation = route->deprecation;
    for (; each && each->name && exchange->parameter_count; each++) {
        if (!parameter_apply(exchange, each, problem)) return false;
    }
    return true;
}

const char *server_deprecation_sent(const struct server_exchange *exchange, const char *parameter)
{
    const struct proto_route *route = exchange->match.route;
    const struct proto_deprecation *each = route ? route->deprecated_parameters : NULL;
    for (; each && each->name && exchange->deprecation; each++) {
        for (uint32_t i = 0; i < exchange->parameter_count; i++) {
            /* the replaced name is this string itself */
            if (exchange->parameters[i].name == each->replacement &&
                strcmp(parameter, each->replacement) == 0)
                return each->name;
        }
    }
    return parameter;
}
