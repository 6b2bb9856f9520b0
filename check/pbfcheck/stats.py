"""Figures of a sample of errors."""
import numpy as np


def of_errors(errors):
    """mean |e|, RMS, p99 and max of |e|, signed mean and extremes; None for an empty sample."""
    keys = ("mean_abs", "rms", "p99", "max", "mean_signed", "lowest", "highest")
    if not len(errors):
        return {"count": 0, **dict.fromkeys(keys)}
    size = np.abs(errors)
    values = (size.mean(), np.sqrt(np.mean(errors**2)), np.percentile(size, 99), size.max(),
              errors.mean(), errors.min(), errors.max())
    return {"count": len(errors), **{k: float(v) for k, v in zip(keys, values)}}


def rms(values):
    return float(np.sqrt(np.mean(np.square(values)))) if len(values) else 0.0


def summary(rows):
    """Per figure over the frames: last, mean, and the value farthest from zero."""
    result = {}
    for key in (k for k in (rows[-1] if rows else {}) if k not in ("step", "time")):
        values = [row[key] for row in rows
                  if isinstance(row.get(key), (int, float)) and not isinstance(row[key], bool)]
        if values:
            last = rows[-1][key]
            result[key] = {"last": last, "mean": float(np.mean(values)),
                           "largest": max(values, key=abs)}
    return result


def prefixed(prefix, values):
    return {f"{prefix}.{key}": value for key, value in values.items()}
