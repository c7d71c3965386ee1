/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where she looks. S. P. Lee, J. B. Badler and N. I. Badler, "Eyes Alive", ACM Trans. Graphics 21 (2002):
 * directions, sizes and durations of glances in talking and listening; who looks away when: A. Kendon, Acta
 * Psychologica 26 (1967); M. Argyle and M. Cook, "Gaze and Mutual Gaze" (1976). */
#include "server/face/life/life_prosody.h"
#include "server/face/life/life_random.h"
#include "server/face/life/life_shift.h"

/* Glances away: seconds at the listener and away, median and deviation of the logarithm. */
#define LISTENER_MEDIAN 3.7
#define LISTENER_DEVIATION 0.6
#define LISTENER_SHORTEST 1.2
#define AWAY_MEDIAN 0.8
#define AWAY_DEVIATION 0.5
#define AWAY_SHORTEST 0.35
#define AWAY_LONGEST 2.5
/* Their size falls off exponentially (A = -6.9 log(P / 15.7)); the smallest counts as looking away. */
#define AWAY_DEGREES 6.9
#define AWAY_SMALLEST 5.0
#define AWAY_LARGEST 20.0
#define AWAY_UP 9.0
#define AWAY_DOWN 12.0

/* Fixations of the listener's eyes, nose and mouth, seen from a metre away. */
#define FIXATION_MEDIAN 0.75
#define FIXATION_DEVIATION 0.6
#define FIXATION_SHORTEST 0.2
#define FIXATION_LONGEST 3.0
#define FIXATION_SCATTER 0.25

/* A saccade takes 21 ms and 2.2 ms for each degree (R. Carpenter, "Movements of the Eyes", 1988). */
#define SACCADE_SECONDS 0.021
#define SACCADE_PER_DEGREE 0.0022

/* The head joins in where eyes alone would have to go far (J. Stahl, Exp. Brain Res. 126, 1999). */
#define HEAD_FROM 7.0
#define HEAD_SHARE 0.55
#define TURN_SECONDS 0.4
#define TURN_PER_DEGREE 0.03
#define ROLL_PER_YAW (-0.15)

/* While speaking: probabilities of a glance away at the start of a sentence, for each second that it lasts,
 * and before a phrase, by the length of the pause and of the phrase. */
#define PLAN_SHORTEST 1.6
#define START_PER_SECOND 0.2
#define START_MOST 0.8
#define HESITATION 0.5
#define HESITATES 0.7
#define LONG_PHRASE 1.4
#define BEFORE_LONG 0.6
#define BEFORE_SHORT 0.25

static void aim(struct shift *s, const struct shift *from, double yaw, double pitch) {
    double size = hypot(yaw, pitch), turn = size > HEAD_FROM ? HEAD_SHARE * (size - HEAD_FROM) / size : 0;
    s->to[GAZE_YAW] = (float)yaw;
    s->to[GAZE_PITCH] = (float)pitch;
    s->to[HEAD_PITCH] = (float)(turn * pitch);
    s->to[HEAD_YAW] = (float)(turn * yaw);
    s->to[HEAD_ROLL] = (float)(ROLL_PER_YAW * turn * yaw);
    double way = hypot(yaw - (double)from->to[GAZE_YAW], pitch - (double)from->to[GAZE_PITCH]);
    double head = hypot((double)(s->to[HEAD_YAW] - from->to[HEAD_YAW]),
                        (double)(s->to[HEAD_PITCH] - from->to[HEAD_PITCH]));
    s->fast = (float)(SACCADE_SECONDS + SACCADE_PER_DEGREE * way);
    s->slow = head > 0 ? (float)fmin(TURN_SECONDS + TURN_PER_DEGREE * head, SHIFT_TURN) : 0;
}

static void look(struct shifts *glances, double at, double yaw, double pitch) {
    struct shift s = {.at = at};
    aim(&s, &glances->items[glances->count - 1], yaw, pitch);
    shifts_add(glances, &s);
}

static void look_at_listener(struct shifts *glances, struct dice *d, double at) {
    static const double face[][2] = {{-1.4, -0.4}, {1.4, -0.4}, {0, 1.6}, {0, 0}};
    const double *place = face[dice_bits(d) >> 62];
    double yaw = place[0] + FIXATION_SCATTER * dice_normal(d);
    look(glances, at, yaw, place[1] + FIXATION_SCATTER * dice_normal(d));
}

static void look_away(struct shifts *glances, struct dice *d, double at) {
    /* percent of the glances in eight directions from the right, anticlockwise, and their unit vectors */
    static const struct {
        double percent, yaw, pitch;
    } directions[] = {{15.54, -1, 0}, {6.46, -0.7, -0.7}, {17.69, 0, -1}, {7.44, 0.7, -0.7},
                      {16.80, 1, 0},  {7.89, 0.7, 0.7},   {20.38, 0, 1},  {7.79, -0.7, 0.7}};
    double size = fmin(AWAY_SMALLEST - AWAY_DEGREES * log(1 - dice_roll(d)), AWAY_LARGEST);
    double roll = 100 * dice_roll(d);
    int i = 0;
    while (i < 7 && (roll -= directions[i].percent) > 0)
        i++;
    /* nobody looks exactly up, down or sideways */
    double aside = 0.25 * dice_normal(d);
    double yaw = size * (directions[i].yaw + aside * directions[i].pitch);
    double pitch = size * (directions[i].pitch - aside * directions[i].yaw);
    look(glances, at, yaw, life_clip(pitch, -AWAY_UP, AWAY_DOWN));
}

static double fixation(struct dice *d) {
    return life_clip(dice_log_normal(d, FIXATION_MEDIAN, FIXATION_DEVIATION), FIXATION_SHORTEST,
                     FIXATION_LONGEST);
}

static double away(struct dice *d) {
    return life_clip(dice_log_normal(d, AWAY_MEDIAN, AWAY_DEVIATION), AWAY_SHORTEST, AWAY_LONGEST);
}

/* Fixations of the listener from..to. */
static void listen(struct shifts *glances, struct dice *d, double from, double to) {
    for (double at = from; at < to; at += fixation(d))
        look_at_listener(glances, d, at);
}

void glances_of_block(struct shifts *glances, uint64_t seed, int64_t block) {
    struct dice d = dice_of(seed, DICE_GLANCES, block);
    double at = life_edge(seed, block), end = life_edge(seed, block + 1) - SHIFT_TURN;
    shifts_add(glances, &(struct shift){.at = at});
    at += fixation(&d);
    for (;;) {
        double stay = fmax(dice_log_normal(&d, LISTENER_MEDIAN, LISTENER_DEVIATION), LISTENER_SHORTEST);
        listen(glances, &d, at, fmin(at + stay, end - FIXATION_SHORTEST));
        at += stay;
        double gone = away(&d);
        if (at + gone > end - FIXATION_SHORTEST)
            break;
        look_away(glances, &d, at);
        at += gone;
    }
    if (at < end - FIXATION_SHORTEST) /* too late for a glance, too early for the end */
        listen(glances, &d, at, end - FIXATION_SHORTEST);
    look(glances, end, 0, 0);
}

/* Seconds to look away from the beginning of a phrase (0 = does not), and how long before it she begins. */
static double shyness(const struct prosody *p, size_t i, struct dice *d, double *before) {
    const struct phrase *phrase = &p->phrases[i];
    double length = phrase->to - phrase->from, pause = i ? phrase->from - phrase[-1].to : 0, chance;
    *before = 0.7 * (i ? pause : fmin(phrase->from, 0.3));
    if (!i)
        chance = fmin(START_PER_SECOND * (p->end - PLAN_SHORTEST), START_MOST);
    else if (pause > HESITATION)
        chance = HESITATES;
    else
        chance = length > LONG_PHRASE ? BEFORE_LONG : BEFORE_SHORT;
    double roll = dice_roll(d), gone = *before + away(d);
    return roll < chance ? fmin(gone, *before + 0.75 * length) : 0;
}

/* The plan: glances from the time `from` on, on the clock, all done by `to`. */
static void plan(struct shifts *out, struct dice *d, const struct prosody *p, double begin, double from,
                 double to) {
    double at = from;
    for (size_t i = 0; i < p->phrase_count; i++) {
        double before, gone = shyness(p, i, d, &before), leave = begin + p->phrases[i].from - before;
        leave = i ? leave : fmax(leave, at);
        if (gone < AWAY_SHORTEST || leave < at || leave + gone > to)
            continue;
        listen(out, d, at, leave - FIXATION_SHORTEST);
        look_away(out, d, leave);
        at = leave + gone;
    }
    listen(out, d, at, to);
}

void glances_of_speech(struct shifts *glances, uint64_t seed, const struct prosody *prosody, double from,
                       double to) {
    /* Saccades and turns of the plan are over when the sentence is. */
    double take = from + 0.05, back = to - SHIFT_TURN - 0.05;
    if (to - from < PLAN_SHORTEST)
        return;
    size_t first = shifts_find(glances, take) + 1, after = shifts_find(glances, back) + 1;
    struct dice d = dice_of(seed, DICE_PLAN, prosody->name);
    struct shifts merged = {0};
    for (size_t i = 0; i < first; i++)
        shifts_add(&merged, &glances->items[i]);
    plan(&merged, &d, prosody, from, fmax(take, glances->items[first - 1].at + 2 * FIXATION_SHORTEST),
         back - FIXATION_SHORTEST);
    const float *there = glances->items[after - 1].to;
    look(&merged, back, (double)there[GAZE_YAW], (double)there[GAZE_PITCH]);
    for (size_t i = after; i < glances->count; i++)
        shifts_add(&merged, &glances->items[i]);
    shifts_free(glances);
    *glances = merged;
}
