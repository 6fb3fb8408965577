-- Claim 1: a fault that moves a crank beyond a limit is detected within one turn and three ticks. `in_time` is empty where no turn was
-- over before the machine stood for good.
SELECT kind, encoder,
    count(*) AS runs,
    count(beyond_limit_s) AS beyond_limit,
    count(*) FILTER (in_time) AS detected,
    count(in_time) AS counted,
    lower_bound(detected, counted) AS at_least,
    upper_bound(detected, counted) AS at_most
FROM faulty GROUP BY GROUPING SETS ((kind, encoder), ()) ORDER BY kind, encoder;
