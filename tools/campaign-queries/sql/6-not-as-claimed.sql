-- Single cases that are not as claimed, or are misnamed: `cophase campaign --seed SEED --replay NUMBER` runs one again.
SELECT seed, scene, number, clean, kind, encoder, state, verdict, turns_from_limit, reported_faults
FROM runs
WHERE verdict IN ('misnamed', 'missed', 'false-trip', 'diverged') OR NOT in_time OR left_running
    OR tilt_over_bound > 1
ORDER BY seed, scene, number, clean;
