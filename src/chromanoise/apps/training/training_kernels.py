# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Noise of one item of training data: rows of clean values to rows of noisy values and variances.

A lane is one value in memory order: a pixel of a mosaic, or a channel of a pixel. Its constants
(gain, read noise, black level ...) come from tables with one row for each row of the mosaic. The
random words depend only on seed, item, row and lane, so rows can be computed in any order.

The counter of the cipher (`philox4x32`): the pixel index is row * 2^24 + number of the call in the
row, the frame is the low half of the item, and the fourth word is a mark that no simulated picture
uses, with the high half of the item.
"""

from typing import no_type_check

import numpy as np

from chromanoise.imaging import (
    ALIASES,
    LANES,
    LEVEL,
    LIGHT,
    PIXEL_GAIN,
    PIXEL_LEVELS,
    READOUT,
    ROW,
    cell_of,
    count_few,
    count_refused,
    exponential_less_one,
    few_more,
    fused,
    inlined,
    inner,
    kernel,
    leading_count,
    list_low,
    minus_log,
    normal_of_words,
    normal_quantile,
    place_of,
    poisson_quantile_of_many,
    read_quantile_of_many,
    room_for,
    start_of,
    words_at,
)

_F = np.float32
_ZERO, _ONE, _HALF = _F(0.0), _F(1.0), _F(0.5)
_INFINITE = _F(np.inf)
_TO_SHARE = _F(2.0**-32)
_HIGH_BIT = np.int32(31)
_LOGISTIC = _F(1e-5)  # as in chromanoise.sensor.noise_sources
_MARK = np.uint64(1 << 15)
_WORD, _HIGH, _SHIFT_16 = np.uint64(0xFFFFFFFF), np.uint64(32), np.uint64(16)
_ROW_AT = 24
_RARE = 6  # fewer than one lane in so many is faster picked out


@kernel(error_model="numpy")
@no_type_check
def add_noise(
    clean, noisy, variance, start, stop, lanes, pattern, use, noise, first_row, item, key
):
    """Fill rows ``start`` to ``stop`` of ``noisy`` and ``variance``; how many values are refused.

    clean, noisy, variance (h, w) f4. lanes (10, rows of the mosaic, w) f4: value of 0 electrons,
    electrons per unit, gain, read noise, code without light, black level, largest code, variance
    that does not depend on light, units per code, and units^2 per electrons^2. pattern:
    sensitivity and dark offset of each pixel (h, w) f4, and offsets of this item (1 or h, w) f4,
    each empty if not used. use: which parts
    are drawn. noise (5,) f4: dark electrons, PRNU, row noise, shape of the read noise, and the
    mean below which electrons are counted.
    """
    width = clean.shape[1]
    most = min(LANES, width)
    words = np.empty(4 * ((most + 3) // 4), np.uint32)
    room, picked = room_for(most), _room_for_picked(most)
    light, counted = np.empty(most, np.float32), np.empty(most, np.float32)
    electrons = np.empty(most, np.float32)
    refused = 0
    for row in range(start, stop):
        phase = (first_row + row) % lanes.shape[1]
        row_e = _ZERO
        if use.row:
            w0, _, _, _ = _words(np.uint64(row) << np.uint64(_ROW_AT), ROW, item, key)
            row_e = noise[2] * normal_quantile(np.uint32(w0))
        for first in range(0, width, most):
            n = min(most, width - first)
            end = first + n
            read_e = lanes[3, phase, first:end]
            given = clean[row, first:end]
            _electrons_of(given, lanes, phase, first, light, n)
            refused += count_refused(light[:n])
            _counted_means(light, pattern, row, first, n, use, noise, counted)
            calls = (np.uint64(row) << np.uint64(_ROW_AT)) + np.uint64(first // 4)
            alone_e = noise[4] if use.together else _INFINITE
            if use.shot or noise[0] > _ZERO:
                fill_lane_words(calls, n, LIGHT, item, key, words)
                draw_counts(counted, read_e, words, n, use, noise[4], room, picked, electrons)
            else:
                electrons[:n] = _ZERO
                alone_e = _INFINITE
            waiting = count_few(counted[:n], alone_e) if use.read else 0
            if waiting > 0:
                fill_lane_words(calls, n, READOUT, item, key, words)
                if _is_rare(waiting, n):
                    add_read_of(picked, waiting, words, read_e, room, electrons)
                else:
                    add_read(counted, alone_e, words, n, read_e, noise[3], use, room, electrons)
            _collect(electrons, light, pattern, row, first, n, use, row_e - noise[0])
            _finish(electrons, lanes, phase, first, n, use, noisy[row, first:end])
            _variance(light, lanes, phase, first, n, use, noise[1], variance[row, first:end])
    return refused


@inlined
@no_type_check
def _words(call, purpose, item, key):
    mark = _MARK | ((item >> _HIGH) << _SHIFT_16)
    return words_at(call, np.uint64(purpose), item & _WORD, mark, key)


@inner
@no_type_check
def fill_lane_words(call, n, purpose, item, key, words):
    """A word for each of ``n`` lanes; a call of the cipher serves lanes a quarter of them apart."""
    quarter = (n + 3) // 4
    w0, w1 = words[:quarter], words[quarter : 2 * quarter]
    w2, w3 = words[2 * quarter : 3 * quarter], words[3 * quarter : 4 * quarter]
    mark = _MARK | ((item >> _HIGH) << _SHIFT_16)
    low, why = item & _WORD, np.uint64(purpose)
    for i in range(quarter):
        four = words_at(call + np.uint64(i), why, low, mark, key)
        w0[i] = four[0]
        w1[i] = four[1]
        w2[i] = four[2]
        w3[i] = four[3]


@inner
@no_type_check
def _electrons_of(given, lanes, phase, first, light, n):
    zero, per_unit = lanes[0, phase, first : first + n], lanes[1, phase, first : first + n]
    for j in range(n):
        light[j] = (given[j] - zero[j]) * per_unit[j]


@inner
@no_type_check
def _counted_means(light, pattern, row, first, n, use, noise, counted):
    """Sensitivity of the pixels, in place; the mean of what is counted: light, dark, or both."""
    gain, dark_e = pattern[0], noise[0]
    if not use.shot:
        counted[:n] = dark_e
    elif gain.size > 0:
        here = gain[row, first : first + n]
        for j in range(n):
            counted[j] = light[j] * here[j] + dark_e
    else:
        for j in range(n):
            counted[j] = light[j] + dark_e


@inner
@no_type_check
def draw_counts(mean, read_e, words, count, use, few_e, room, picked, electrons):
    """Electrons of ``count`` lanes, from ``few_e`` on together with read noise if so used."""
    _, normal, logs = room
    few = count_few(mean[:count], few_e)
    if few < count:
        normal_of_words(words, count, normal, logs)
        if use.together:
            for j in range(count):
                electrons[j] = read_quantile_of_many(mean[j], read_e[j] * read_e[j], normal[j])
        else:
            for j in range(count):
                electrons[j] = poisson_quantile_of_many(mean[j], normal[j])
    if _is_rare(few, count):
        lanes, low, word, found = picked
        list_low(mean, count, few_e, lanes)
        for j in range(few):
            low[j] = mean[np.uintp(lanes[j])]
            word[j] = words[np.uintp(lanes[j])]
        count_by_table(low, few_e, word, few, room, found)
        for j in range(few):
            electrons[np.uintp(lanes[j])] = found[j]
    elif few > 0:
        count_by_table(mean, few_e, words, count, room, electrons)


@inlined
@no_type_check
def _is_rare(few, count):
    """Whether these lanes are picked out, instead of drawing all and keeping theirs."""
    return 0 < few < count // _RARE


@inner
@no_type_check
def _room_for_picked(count):
    """Scratch for lanes of low mean: which ones, their means and words, and what is drawn."""
    number = np.empty(count, np.float32)
    return np.empty(count, np.int32), number, np.empty(count, np.uint32), np.empty_like(number)


@kernel(error_model="numpy")
@no_type_check
def count_by_table(mean, few_e, words, count, room, electrons):
    """Replace ``electrons`` by Poisson counts in those of ``count`` lanes with means < ``few_e``.

    Every lane is drawn, because loops without lists of lanes vectorize; only the table is not read
    in parallel.
    """
    entry, rest, share = room
    for j in range(count):
        cell = cell_of(mean[j])
        rest[j] = mean[j] - start_of(cell)
        entry[j] = place_of(cell, words[j])
    for j in range(count):
        entry[j] = ALIASES[np.uintp(entry[j])]
    for j in range(count):
        entry[j], share[j] = leading_count(entry[j], words[j])
    for j in range(count):
        found = _F(entry[j]) + few_more(rest[j], share[j])
        electrons[j] = found if mean[j] < few_e else electrons[j]


@inner
@no_type_check
def add_read(mean, alone_e, words, count, read_e, shape, use, room, electrons):
    """Add read noise to those of ``count`` lanes with means < ``alone_e``."""
    _, normal, logs = room
    if use.tails:
        tail_scores(words, count, shape, normal, logs)
    else:
        normal_of_words(words, count, normal, logs)
    for j in range(count):
        added = electrons[j] + read_e[j] * normal[j]
        electrons[j] = added if mean[j] < alone_e else electrons[j]


@inner
@no_type_check
def add_read_of(picked, count, words, read_e, room, electrons):
    """Add normal read noise to the ``count`` lanes that are listed in ``picked``."""
    lanes, _, word, _ = picked
    _, normal, logs = room
    for j in range(count):
        word[j] = words[np.uintp(lanes[j])]
    normal_of_words(word, count, normal, logs)
    for j in range(count):
        lane = np.uintp(lanes[j])
        electrons[lane] = electrons[lane] + read_e[lane] * normal[j]


@kernel(error_model="numpy")
@no_type_check
def tail_scores(words, count, shape, scores, logs):
    """Tukey lambda variates of scale 1 (f4) of ``count`` words: (u^s - (1 - u)^s) / s.

    With H = -ln of the larger of u and 1 - u and D = ln u - ln(1 - u) their size is
    e^(-s H) (1 - e^(-s |D|)) / s. It errs by 1e-6 of it or of the standard deviation.
    """
    for j in range(count):
        signed = np.int32(words[j])
        folded = np.int32(signed ^ np.int32(signed >> _HIGH_BIT))
        tail = (_F(folded) + _HALF) * _TO_SHARE
        high = minus_log(_ONE - tail)
        away = minus_log(tail) - high
        logs[j] = high
        scores[j] = away if signed < 0 else -away
    if abs(shape) <= _LOGISTIC:
        return
    scale = -_ONE / shape
    for j in range(count):
        size = exponential_less_one(-shape * abs(scores[j])) * scale
        size = fused(exponential_less_one(-shape * logs[j]), size, size)
        scores[j] = size if scores[j] > _ZERO else -size


@inner
@no_type_check
def _collect(electrons, light, pattern, row, first, n, use, shared):
    """Add what is not counted: light without shot noise, and offsets of the row and the pixels."""
    gain_map, offset_map, item_map = pattern
    if not use.shot:
        if gain_map.size > 0:
            here = gain_map[row, first : first + n]
            for j in range(n):
                electrons[j] = electrons[j] + light[j] * here[j]
        else:
            for j in range(n):
                electrons[j] = electrons[j] + light[j]
    if shared != _ZERO:
        for j in range(n):
            electrons[j] = electrons[j] + shared
    if offset_map.size > 0:
        there = offset_map[row, first : first + n]
        for j in range(n):
            electrons[j] = electrons[j] + there[j]
    if item_map.size > 0:
        now = item_map[row % item_map.shape[0], first : first + n]
        for j in range(n):
            electrons[j] = electrons[j] + now[j]


@inner
@no_type_check
def _finish(electrons, lanes, phase, first, n, use, noisy):
    """Codes, and back to the unit of the clean values."""
    end = first + n
    zero, gain = lanes[0, phase, first:end], lanes[2, phase, first:end]
    offset, black = lanes[4, phase, first:end], lanes[5, phase, first:end]
    top, scale = lanes[6, phase, first:end], lanes[8, phase, first:end]
    if use.quantize and use.clamp:
        for j in range(n):
            code = np.floor(electrons[j] * gain[j] + offset[j] + _HALF)
            code = min(max(code, _ZERO), top[j])
            noisy[j] = (code - black[j]) * scale[j] + zero[j]
    elif use.quantize:
        for j in range(n):
            code = np.floor(electrons[j] * gain[j] + offset[j] + _HALF)
            noisy[j] = (code - black[j]) * scale[j] + zero[j]
    elif use.clamp:
        for j in range(n):
            code = electrons[j] * gain[j] + (offset[j] - black[j])
            code = min(max(code, -black[j]), top[j] - black[j])
            noisy[j] = code * scale[j] + zero[j]
    else:
        for j in range(n):
            code = electrons[j] * gain[j] + (offset[j] - black[j])
            noisy[j] = code * scale[j] + zero[j]


@inner
@no_type_check
def _variance(light, lanes, phase, first, n, use, gain_sd, variance):
    """Shot noise, PRNU and what does not depend on light, in the square of the unit."""
    fixed, scale = lanes[7, phase, first : first + n], lanes[9, phase, first : first + n]
    shot = _ONE if use.shot else _ZERO
    square = gain_sd * gain_sd
    for j in range(n):
        variance[j] = (light[j] * (shot + square * light[j]) + fixed[j]) * scale[j]


@kernel(error_model="numpy")
@no_type_check
def draw_levels(share, level_e, first_row, first_lane, pattern, item, key, values):
    """Add + or - ``level_e`` to a share of the pixels (h, w) f4: which ones, by the pattern."""
    for row in range(values.shape[0]):
        start = np.uint64(first_row + row) << np.uint64(_ROW_AT)
        now = np.uint64(row) << np.uint64(_ROW_AT)
        for j in range(values.shape[1]):
            lane = first_lane + j
            which = _word_of(start + np.uint64(lane // 4), PIXEL_LEVELS, pattern, lane % 4, key)
            if _F(which & _WORD) * _TO_SHARE < share:
                word = _word_of(now + np.uint64(j // 4), LEVEL, item, j % 4, key)
                up = (word & np.uint64(1)) == np.uint64(1)
                values[row, j] += level_e if up else -level_e


@inlined
@no_type_check
def _word_of(call, purpose, number, k, key):
    four = _words(call, purpose, number, key)
    return four[0] if k == 0 else four[1] if k == 1 else four[2] if k == 2 else four[3]


@kernel(error_model="numpy")
@no_type_check
def draw_pattern(spread, floor, purpose, first_row, first_lane, number, key, values):
    """Fixed pattern (h, w) f4: 1 or 0 + spread z, at the lanes of a sensor from a place on."""
    mean = _ONE if purpose == PIXEL_GAIN else _ZERO
    why = np.uint64(purpose)
    for row in range(values.shape[0]):
        start = np.uint64(first_row + row) << np.uint64(_ROW_AT)
        for j in range(values.shape[1]):
            lane = first_lane + j
            word = _word_of(start + np.uint64(lane // 4), why, number, lane % 4, key)
            values[row, j] = max(mean + spread * normal_quantile(np.uint32(word)), floor)
