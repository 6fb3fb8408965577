-- Claim 5: with noise alone, nothing is reported. A machine that did not move does not count.
SELECT
    count(*) FILTER (verdict <> 'clean') AS false_trips,
    count(*) AS clean_runs,
    lower_bound(false_trips, clean_runs) AS at_least,
    upper_bound(false_trips, clean_runs) AS at_most
FROM runs WHERE clean AND verdict <> 'moot';
