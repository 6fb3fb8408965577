-- Claim 1: turns of the master from the limit to three ticks before the detection. A quantile is the least value that so large a part of
-- all values is at most.
WITH latencies AS (
    SELECT kind, encoder, list_sort(list(turns_from_limit) FILTER (turns_from_limit IS NOT NULL)) AS turns
    FROM faulty GROUP BY GROUPING SETS ((kind, encoder), ())
)
SELECT kind, encoder, len(turns) AS latencies,
    quantile_of(turns, 0.5) AS half,
    quantile_of(turns, 0.95) AS of_95,
    quantile_of(turns, 0.99) AS of_99,
    quantile_of(turns, 1) AS all_of_them
FROM latencies ORDER BY kind, encoder;
