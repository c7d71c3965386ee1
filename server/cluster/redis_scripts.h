/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What Redis does at one blow, in its Lua. KEYS: the value, the claim. ARGV: who asks; further as each says.
 */
#ifndef FACCIA_CLUSTER_REDIS_SCRIPTS_H
#define FACCIA_CLUSTER_REDIS_SCRIPTS_H

/* The value; or 1: the claim is the asker's from now on; or 0: it is somebody else's. ARGV: the claim's ms,
 * the value's seconds. */
#define SCRIPT_ASK                                                                                           \
    "local value = redis.call('GET', KEYS[1]) "                                                              \
    "if value then redis.call('EXPIRE', KEYS[1], ARGV[3]) return value end "                                 \
    "if redis.call('SET', KEYS[2], ARGV[1], 'NX', 'PX', ARGV[2]) then return 1 end "                         \
    "return 0"

/* The claim lasts, unless somebody else has it by now. ARGV: its ms. */
#define SCRIPT_MAKING                                                                                        \
    "local who = redis.call('GET', KEYS[2]) "                                                                \
    "if not who or who == ARGV[1] then redis.call('SET', KEYS[2], ARGV[1], 'PX', ARGV[2]) end "              \
    "return 0"

/* The claim ends. */
#define SCRIPT_LEAVE                                                                                         \
    "if redis.call('GET', KEYS[2]) == ARGV[1] then redis.call('DEL', KEYS[2]) end "                          \
    "return 0"

/* The same, with the value. ARGV: the value, its seconds. */
#define SCRIPT_GIVE "redis.call('SET', KEYS[1], ARGV[2], 'EX', ARGV[3]) " SCRIPT_LEAVE

#endif
