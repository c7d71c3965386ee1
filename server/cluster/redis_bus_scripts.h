/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What Redis does at one blow for the bus, in its Lua. KEYS: the lease. */
#ifndef FACCIA_CLUSTER_REDIS_BUS_SCRIPTS_H
#define FACCIA_CLUSTER_REDIS_BUS_SCRIPTS_H

/* "HOLDER TOKEN". KEYS: and the counter of tokens. ARGV: who claims, ms, above which number the token is. */
#define SCRIPT_CLAIM                                                                                         \
    "local held = redis.call('GET', KEYS[1]) "                                                               \
    "if not held then "                                                                                      \
    "local token = redis.call('INCR', KEYS[2]) "                                                             \
    "if token <= tonumber(ARGV[3]) then "                                                                    \
    "token = tonumber(ARGV[3]) + 1 redis.call('SET', KEYS[2], string.format('%d', token)) end "              \
    "held = ARGV[1] .. ' ' .. string.format('%d', token) "                                                   \
    "redis.call('SET', KEYS[1], held, 'PX', ARGV[2]) "                                                       \
    "elseif string.sub(held, 1, #ARGV[1]) == ARGV[1] then redis.call('PEXPIRE', KEYS[1], ARGV[2]) end "      \
    "return held"

/* 1, or 0: the lease is not held so any more, and nothing was sent. ARGV: "HOLDER TOKEN", what is sent, the
 * channels that it goes to. */
#define SCRIPT_SEND                                                                                          \
    "if redis.call('GET', KEYS[1]) ~= ARGV[1] then return 0 end "                                            \
    "for i = 3, #ARGV do redis.call('PUBLISH', ARGV[i], ARGV[2]) end "                                       \
    "return 1"

/* The same, and nobody holds the lease. */
#define SCRIPT_GIVE_UP                                                                                       \
    "if redis.call('GET', KEYS[1]) ~= ARGV[1] then return 0 end "                                            \
    "redis.call('DEL', KEYS[1]) "                                                                            \
    "for i = 3, #ARGV do redis.call('PUBLISH', ARGV[i], ARGV[2]) end "                                       \
    "return 1"

#endif
