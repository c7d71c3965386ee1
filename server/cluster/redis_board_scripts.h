/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What Redis does at one blow for the board, in its Lua.
 * "faccia:board" has the daemons by the time at which they looked last, "faccia:board:notes:ID" the notes of
 * one, "faccia:board:marks" the marks by the time of their making, "faccia:board:ends" those that end by
 * that, "faccia:board:count" how often something changed, and "faccia:board:changes" which change was the
 * last of which note ("ID NAME") or mark ("* NAME"). */
#ifndef FACCIA_CLUSTER_REDIS_BOARD_SCRIPTS_H
#define FACCIA_CLUSTER_REDIS_BOARD_SCRIPTS_H

#define REDIS_BOARD "faccia:board"

/* How many changes are told at a time; more than one look can make (BATCH in redis_board.c). */
#define REDIS_BOARD_ROWS "512"

/* KEYS: REDIS_BOARD. ARGV: who looks, up to which change it knows, ms that a daemon lives, how many marks are
 * kept; then by threes: "n" and "f" a note and its text (f: nobody needs to know any more that it is gone),
 * "m" a mark, and when it ends in ms since 1970, or "". {its clock in ms, 1: it was not known here, or
 * something was lost, up to which change it knows now, 1: there is more, how many notes of its are here, how
 * many marks, {the daemons}, {who, name, text,
 * ...}}. Who was not known here is told all from the beginning. */
#define SCRIPT_LOOK                                                                                          \
    "local k, id, life = KEYS[1], ARGV[1], tonumber(ARGV[3]) "                                               \
    "local t = redis.call('TIME') "                                                                          \
    "local now = t[1] * 1000 + math.floor(t[2] / 1000) "                                                     \
    "local notes, changes, marks = k .. ':notes:' .. id, k .. ':changes', k .. ':marks' "                    \
    "local ends = k .. ':ends' "                                                                             \
    "local function drop(names) for _, name in ipairs(names) do "                                            \
    "redis.call('ZREM', marks, name) redis.call('ZREM', ends, name) "                                        \
    "redis.call('ZREM', changes, '* ' .. name) end return #names end "                                       \
    "drop(redis.call('ZRANGE', ends, '-inf', now, 'BYSCORE', 'LIMIT', 0, 100)) "                             \
    "local count = tonumber(redis.call('GET', k .. ':count') or '0') "                                       \
    "local since = tonumber(ARGV[2]) "                                                                       \
    "local fresh = (not redis.call('ZSCORE', k, id) or since > count) and 1 or 0 "                           \
    "if fresh == 1 then since = 0 end "                                                                      \
    "redis.call('ZADD', k, now, id) "                                                                        \
    "for _, dead in ipairs(redis.call('ZRANGE', k, '-inf', now - life, 'BYSCORE', 'LIMIT', 0, 10)) do "      \
    "for _, name in ipairs(redis.call('HKEYS', k .. ':notes:' .. dead)) do "                                 \
    "redis.call('ZREM', changes, dead .. ' ' .. name) end "                                                  \
    "redis.call('DEL', k .. ':notes:' .. dead) redis.call('ZREM', k, dead) end "                             \
    "if #ARGV > 4 then count = redis.call('INCR', k .. ':count') end "                                       \
    "for i = 5, #ARGV, 3 do "                                                                                \
    "if ARGV[i] == 'm' then "                                                                                \
    "if not redis.call('ZSCORE', marks, ARGV[i + 1]) then "                                                  \
    "redis.call('ZADD', marks, now, ARGV[i + 1]) "                                                           \
    "if ARGV[i + 2] ~= '' then redis.call('ZADD', ends, ARGV[i + 2], ARGV[i + 1]) end "                      \
    "redis.call('ZADD', changes, count, '* ' .. ARGV[i + 1]) end "                                           \
    "elseif ARGV[i] == 'f' then "                                                                            \
    "redis.call('HDEL', notes, ARGV[i + 1]) redis.call('ZREM', changes, id .. ' ' .. ARGV[i + 1]) "          \
    "else redis.call('HSET', notes, ARGV[i + 1], ARGV[i + 2]) "                                              \
    "redis.call('ZADD', changes, count, id .. ' ' .. ARGV[i + 1]) end end "                                  \
    "local over = redis.call('ZCARD', marks) - tonumber(ARGV[4]) "                                           \
    "if over > 0 then over = over - drop(redis.call('ZRANGE', ends, 0, over - 1)) end "                      \
    "if over > 0 then drop(redis.call('ZRANGE', marks, 0, over - 1)) end "                                   \
    "local found = redis.call('ZRANGE', changes, since + 1, '+inf', 'BYSCORE', 'LIMIT', "                    \
    "0, " REDIS_BOARD_ROWS ", 'WITHSCORES') "                                                                \
    "local more, known, rows = 0, count, {} "                                                                \
    "if #found == 2 * " REDIS_BOARD_ROWS " then more = 1 known = tonumber(found[#found]) - 1 end "           \
    "for i = 1, #found, 2 do "                                                                               \
    "local space = string.find(found[i], ' ', 1, true) "                                                     \
    "local who, name = string.sub(found[i], 1, space - 1), string.sub(found[i], space + 1) "                 \
    "if who ~= id then "                                                                                     \
    "local text "                                                                                            \
    "if who == '*' then text = redis.call('ZSCORE', ends, name) or '' "                                      \
    "else text = redis.call('HGET', k .. ':notes:' .. who, name) end "                                       \
    "if text then rows[#rows + 1] = who rows[#rows + 1] = name rows[#rows + 1] = text end end end "          \
    "return {now, fresh, known, more, redis.call('HLEN', notes), redis.call('ZCARD', marks), "               \
    "redis.call('ZRANGE', k, 0, 1000), rows}"

#endif
